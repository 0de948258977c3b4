//! A graph beside what a dense solver needs to know of it.

use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose},
    graph::{EllipsoidId, Factor, FactorId, Graph, PoseId, SolverSettings, Variable, VariableId},
};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// A graph, its factors and the initial values of its variables.
pub(super) struct Twin {
    pub(super) graph: Graph,
    pub(super) values: BTreeMap<VariableId, Variable>,
    pub(super) factors: BTreeMap<FactorId, Box<dyn Factor>>,
    pub(super) poses: Vec<PoseId>,
    pub(super) ellipsoids: Vec<EllipsoidId>,
}

impl Twin {
    pub(super) fn new(settings: SolverSettings) -> Self {
        Self {
            graph: Graph::new(settings),
            values: BTreeMap::new(),
            factors: BTreeMap::new(),
            poses: Vec::new(),
            ellipsoids: Vec::new(),
        }
    }

    pub(super) fn add_pose(&mut self, initial: Pose) -> PoseId {
        let id = self.graph.add_pose(initial);
        self.values.insert(id.into(), Variable::Pose(initial));
        self.poses.push(id);
        id
    }

    pub(super) fn add_ellipsoid(&mut self, initial: Ellipsoid) -> EllipsoidId {
        let id = self.graph.add_ellipsoid(initial);
        self.values.insert(id.into(), Variable::Ellipsoid(initial));
        self.ellipsoids.push(id);
        id
    }

    pub(super) fn add(&mut self, factor: impl Factor + Clone + 'static) -> FactorId {
        let id = self.graph.add_factor(factor.clone());
        self.factors.insert(id, Box::new(factor));
        id
    }

    pub(super) fn remove_factor(&mut self, factor: FactorId) {
        self.graph.remove_factor(factor);
        self.factors.remove(&factor);
    }

    pub(super) fn remove_variable(&mut self, variable: impl Into<VariableId>) {
        let variable = variable.into();
        self.graph.remove_variable(variable);
        self.values.remove(&variable);
        self.factors.retain(|_, factor| !factor.variables().contains(&variable));
        self.poses.retain(|id| VariableId::from(*id) != variable);
        self.ellipsoids.retain(|id| VariableId::from(*id) != variable);
    }

    /// What the graph estimates.
    pub(super) fn estimate(&self) -> BTreeMap<VariableId, Variable> {
        let poses = self.poses.iter().map(|id| ((*id).into(), self.graph.pose(*id).into_value()));
        let bodies = self.ellipsoids.iter();
        let bodies = bodies.map(|id| ((*id).into(), self.graph.ellipsoid(*id).into_value()));
        poses.chain(bodies).collect()
    }

    /// The graph's optimum until nothing moves any more, not only the cost.
    pub(super) fn converge(&mut self) {
        (0..40).for_each(|_| {
            self.graph.optimize(1, 0.0).unwrap();
        });
    }

    pub(super) fn dense(&self) -> Dense<'_> {
        let mut first_row = BTreeMap::new();
        let mut size = 0;
        for (id, value) in &self.values {
            first_row.insert(*id, size);
            size += value.dimension();
        }
        Dense { factors: self.factors.values().map(AsRef::as_ref).collect(), first_row, size }
    }
}

trait IntoValue {
    fn into_value(self) -> Variable;
}

impl IntoValue for Pose {
    fn into_value(self) -> Variable {
        Variable::Pose(self)
    }
}

impl IntoValue for Ellipsoid {
    fn into_value(self) -> Variable {
        Variable::Ellipsoid(self)
    }
}

type Values = BTreeMap<VariableId, Variable>;

/// Levenberg-Marquardt on one dense matrix.
pub(super) struct Dense<'a> {
    factors: Vec<&'a dyn Factor>,
    pub(super) first_row: BTreeMap<VariableId, usize>,
    size: usize,
}

impl Dense<'_> {
    fn at(factor: &dyn Factor, values: &Values) -> Vec<Variable> {
        factor.variables().iter().map(|v| values[v]).collect()
    }

    pub(super) fn cost(&self, values: &Values) -> f64 {
        let cost = |factor: &&dyn Factor| {
            factor.kernel().cost(factor.residual(&Self::at(*factor, values)).norm_squared())
        };
        self.factors.iter().map(cost).sum()
    }

    /// The information matrix with the kernels' weights, and the descent direction.
    pub(super) fn normal_equations(&self, values: &Values) -> (DMatrix<f64>, DVector<f64>) {
        let mut information = DMatrix::zeros(self.size, self.size);
        let mut descent = DVector::zeros(self.size);
        for factor in &self.factors {
            let linear = factor.linearize(&Self::at(*factor, values));
            let weight = factor.kernel().weight(linear.residual.norm_squared());
            let rows: Vec<usize> = factor
                .variables()
                .iter()
                .flat_map(|v| self.first_row[v]..self.first_row[v] + values[v].dimension())
                .collect();
            let own = linear.jacobian.tr_mul(&linear.jacobian) * weight;
            let right = linear.jacobian.tr_mul(&linear.residual) * weight;
            for (i, row) in rows.iter().enumerate() {
                descent[*row] -= right[i];
                rows.iter()
                    .enumerate()
                    .for_each(|(j, column)| information[(*row, *column)] += own[(i, j)]);
            }
        }
        (information, descent)
    }

    pub(super) fn optimum(&self, initial: &Values) -> Values {
        let (mut values, mut damping) = (initial.clone(), 1e-3);
        let mut cost = self.cost(&values);
        for _ in 0..200 {
            let (mut information, descent) = self.normal_equations(&values);
            (0..self.size).for_each(|i| information[(i, i)] += damping);
            let step = information.cholesky().unwrap().solve(&descent);
            let moved: Values = values
                .iter()
                .map(|(id, value)| {
                    let own = step.rows(self.first_row[id], value.dimension()).into_owned();
                    (*id, value.retract(own.as_slice()))
                })
                .collect();
            let new_cost = self.cost(&moved);
            if new_cost <= cost {
                (values, cost, damping) = (moved, new_cost, (damping * 0.1).max(1e-9));
            } else {
                damping *= 10.0;
            }
            if step.amax() < 1e-10 {
                break;
            }
        }
        values
    }
}

/// The largest difference of any variable's tangent (rad, m, 1).
pub(super) fn distance(a: &Values, b: &Values) -> f64 {
    assert!(a.keys().eq(b.keys()));
    a.iter().map(|(id, value)| value.local(&b[id]).amax()).fold(0.0, f64::max)
}

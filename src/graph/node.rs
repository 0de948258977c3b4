//! What the graph keeps of each variable and each factor.

use super::{Factor, Variable, quadratic::Quadratic};
use nalgebra::DMatrix;

/// The tangent of a variable; a pose uses the first six elements.
pub(super) type Tangent = [f64; 9];

/// A variable and where the solver stands with it.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Where its factors are linearised.
    pub(super) linearized_at: Variable,
    /// The solution of the linear system, from there.
    pub(super) delta: Tangent,
    /// `linearized_at` moved by `delta`.
    pub(super) estimate: Variable,
    /// The `delta` that the variables below it in the tree know of.
    pub(super) announced: Tangent,
    /// Diagonal of the information that all its factors have about it.
    pub(super) stiffness: Tangent,
    pub(super) dimension: usize,
    pub(super) factors: Vec<u32>,
}

impl Node {
    pub(super) fn new(initial: Variable) -> Self {
        Self {
            linearized_at: initial,
            delta: [0.0; 9],
            estimate: initial,
            announced: [0.0; 9],
            stiffness: [0.0; 9],
            dimension: initial.dimension(),
            factors: Vec::new(),
        }
    }

    /// By about how much the cost is higher as long as nobody else knows of its latest change: as if all others stood
    /// still. Correlations within the variable are left out.
    pub(super) fn cost_of_silence(&self) -> f64 {
        let changes = self.delta.iter().zip(&self.announced).map(|(new, old)| new - old);
        0.5 * changes.zip(&self.stiffness).map(|(d, h)| h * d * d).sum::<f64>()
    }

    /// Moves the point of linearisation to the estimate.
    pub(super) fn relinearize(&mut self) {
        self.linearized_at = self.estimate;
        (self.delta, self.announced) = ([0.0; 9], [0.0; 9]);
    }

    /// Whether the estimate is where the factors were linearised.
    pub(super) fn is_at_linearization(&self) -> bool {
        self.delta == [0.0; 9]
    }

    pub(super) fn set_delta(&mut self, delta: Tangent) {
        self.delta = delta;
        self.estimate = self.linearized_at.retract(&delta[..self.dimension]);
    }
}

/// What a factor costs, and by how much its kernel reduces its information: iteratively reweighted least squares
/// (Zhang 1997).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Price {
    /// At the estimate; what has changed a little since the appraisal is by the linear model.
    pub(super) cost: f64,
    /// The cost when it was last computed from the residual, and all that follows is of then.
    pub(super) appraised: f64,
    /// Half the squared norm of the whitened residual by the linear model.
    pub(super) model: f64,
    pub(super) weight: f64,
    /// How far the linear model is from the truth, in units of one plus the true cost without a kernel.
    pub(super) linear_error: f64,
    /// How far the weight that was eliminated with is from `weight`, as cost in the same units.
    pub(super) weight_error: f64,
}

/// A factor and its linearisation.
#[derive(Debug)]
pub(super) struct Term {
    pub(super) factor: Box<dyn Factor>,
    /// At `linearized_at` of its variables, without its kernel.
    pub(super) quadratic: Quadratic,
    /// Squared norm of the whitened residual at `linearized_at`.
    squared_norm: f64,
    /// Its kernel's weight when it was eliminated.
    pub(super) weight: f64,
    /// At the estimate.
    pub(super) price: Price,
    /// When it was priced, as the number of the round.
    pub(super) pricing: u64,
}

impl Term {
    pub(super) fn new(factor: Box<dyn Factor>) -> Self {
        let variables = factor.variables().iter().map(|v| v.0.index).collect();
        Self {
            factor,
            quadratic: Quadratic::empty(variables),
            squared_norm: 0.0,
            weight: 0.0,
            price: Price::default(),
            pricing: 0,
        }
    }

    /// The indices of its variables.
    pub(super) fn variables(&self) -> &[u32] {
        &self.quadratic.variables
    }

    /// Half the squared norm of the whitened residual by the linear model.
    pub(super) fn model(&self, nodes: &[Node]) -> f64 {
        let mut delta = [0.0; MAX_DIMENSION];
        let mut size = 0;
        for variable in self.variables() {
            let node = &nodes[*variable as usize];
            delta[size..size + node.dimension].copy_from_slice(&node.delta[..node.dimension]);
            size += node.dimension;
        }
        0.5 * self.squared_norm + self.quadratic.value(&delta[..size])
    }

    /// The price at the estimate.
    pub(super) fn appraise(&self, nodes: &[Node]) -> Price {
        let variables = self.variables().iter();
        let is_linearized_here = !self.quadratic.is_empty()
            && variables.into_iter().all(|v| nodes[*v as usize].is_at_linearization());
        let squared_norm = if is_linearized_here {
            self.squared_norm
        } else {
            let at = self.values(nodes, |node| node.estimate);
            self.factor.residual(&at).norm_squared()
        };
        let (kernel, model, truth) = (self.factor.kernel(), self.model(nodes), 0.5 * squared_norm);
        let weight = kernel.weight(squared_norm);
        let cost = kernel.cost(squared_norm);
        Price {
            cost,
            appraised: cost,
            model,
            weight,
            linear_error: (model - truth).abs() / (1.0 + truth),
            weight_error: (weight - self.weight).abs() * truth / (1.0 + truth),
        }
    }

    /// Makes the quadratic form of Gauss-Newton at the point of linearisation; returns what to restore.
    pub(super) fn linearize(&mut self, nodes: &[Node]) -> (Quadratic, f64) {
        let at = self.values(nodes, |node| node.linearized_at);
        let linear = self.factor.linearize(&at);
        let size = linear.jacobian.ncols();
        let mut augmented = DMatrix::zeros(size + 1, size + 1);
        augmented
            .view_mut((0, 0), (size, size))
            .copy_from(&linear.jacobian.tr_mul(&linear.jacobian));
        let gradient = linear.jacobian.tr_mul(&linear.residual);
        augmented.view_mut((size, 0), (1, size)).copy_from(&-gradient.transpose());
        let quadratic = Quadratic::from_augmented(self.quadratic.variables.clone(), &augmented, 0);
        self.restore((quadratic, linear.residual.norm_squared()))
    }

    /// Adds what the factor says about its variables to their stiffness.
    pub(super) fn stiffen(&self, nodes: &mut [Node], sign: f64) {
        let mut diagonal = self.quadratic.diagonal();
        for variable in self.variables() {
            let node = &mut nodes[*variable as usize];
            let own = node.stiffness.iter_mut().take(node.dimension).zip(&mut diagonal);
            own.for_each(|(stiffness, information)| *stiffness += sign * information);
        }
    }

    /// Puts back what [`Term::linearize`] returned.
    pub(super) fn restore(
        &mut self,
        (quadratic, squared_norm): (Quadratic, f64),
    ) -> (Quadratic, f64) {
        let squared_norm = std::mem::replace(&mut self.squared_norm, squared_norm);
        (std::mem::replace(&mut self.quadratic, quadratic), squared_norm)
    }

    fn values(&self, nodes: &[Node], of: impl Fn(&Node) -> Variable) -> Vec<Variable> {
        self.variables().iter().map(|v| of(&nodes[*v as usize])).collect()
    }
}

/// Of the tangents of a factor's variables together: two ellipsoids are the most that any factor ties.
const MAX_DIMENSION: usize = 18;

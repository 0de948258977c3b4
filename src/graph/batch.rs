//! The solution of everything at once.

use super::{Graph, Undetermined, incremental::Scope};

/// What a batch solution did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveReport {
    /// Before the first iteration.
    pub initial_cost: f64,
    /// After the last one.
    pub final_cost: f64,
    /// Iterations that were made.
    pub iterations: usize,
    /// Why it ended.
    pub stop: Stop,
}

/// Why a batch solution ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The cost does not fall any more.
    Converged,
    /// No more iterations were allowed.
    MaxIterations,
}

impl Graph {
    /// Linearises and solves everything until the cost does not fall by more than `relative_decrease`, with an order
    /// of elimination made for the whole: what follows a large loop, or ends a run.
    ///
    /// # Errors
    /// When a variable is undetermined; the graph is as before, without what was added since the last update.
    pub fn optimize(
        &mut self,
        max_iterations: usize,
        relative_decrease: f64,
    ) -> Result<SolveReport, Undetermined> {
        let mut report = SolveReport {
            initial_cost: f64::NAN,
            final_cost: f64::NAN,
            iterations: 0,
            stop: Stop::MaxIterations,
        };
        while report.iterations < max_iterations {
            let step = self.step(Scope::Everything)?;
            let cost = self.cost();
            if report.iterations == 0 {
                report.initial_cost = cost + step.cost_before - step.cost_after;
            }
            report.iterations += 1;
            report.final_cost = cost;
            if step.cost_before - step.cost_after <= relative_decrease * cost {
                report.stop = Stop::Converged;
                break;
            }
        }
        Ok(report)
    }
}

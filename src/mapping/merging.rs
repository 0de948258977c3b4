//! One object out of two, and objects that are no more.

use super::{ObjectId, ObjectMap};
use crate::graph::NoiseError;
use thiserror::Error;

/// Why objects could not be merged or removed. The map is as it was.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum MergeError {
    /// There is no such object.
    #[error("there is no object {0} in the map")]
    Unknown(ObjectId),
    /// An object that is to stay.
    #[error("object {0} is locked")]
    Locked(ObjectId),
    /// An object cannot be merged into itself.
    #[error("object {0} is to be merged into itself")]
    Same(ObjectId),
    /// The graph could not be solved with it.
    #[error("the graph cannot do it: {0}")]
    Graph(String),
}

impl ObjectMap {
    /// Makes one object of two that are the same thing: `kept` gets all measurements of `gone`, and the graph is solved
    /// with them.
    ///
    /// # Errors
    /// When there are no such two objects, `gone` is locked, or the graph cannot be solved; nothing has changed then.
    pub fn merge(&mut self, kept: ObjectId, gone: ObjectId) -> Result<(), MergeError> {
        if kept == gone {
            return Err(MergeError::Same(kept));
        }
        let before = self.objects[self.known(kept)?].clone();
        let gone_at = self.known(gone)?;
        if self.objects[gone_at].locked {
            return Err(MergeError::Locked(gone));
        }
        let other = self.objects.remove(gone_at);
        let at = self.known(kept)?;
        let absorbed =
            self.objects[at].absorb(&mut self.graph, other.clone(), (&self.settings, &self.slam));
        let solved = self.solved(absorbed);
        match solved {
            Ok(forgotten) => {
                self.forget_neighbour(gone);
                self.chain.note_loose(forgotten);
                self.refresh([at].into_iter());
                Ok(())
            }
            Err(why) => {
                self.objects[at] = before;
                self.objects.insert(gone_at, other);
                Err(why)
            }
        }
    }

    /// Takes an object out of the map, with all its measurements.
    ///
    /// # Errors
    /// When there is no such object or the graph cannot be solved without it; nothing has changed then.
    pub fn remove(&mut self, id: ObjectId) -> Result<(), MergeError> {
        let at = self.known(id)?;
        let seen_from = self.objects[at].leave(&mut self.graph);
        self.solved(Ok(()))?;
        self.objects.remove(at);
        self.forget_neighbour(id);
        self.chain.note_loose(seen_from);
        self.refresh([].into_iter());
        Ok(())
    }

    /// Gives `into` the measurements of `from` that are its own: what was one object turned out to be two. Returns how
    /// many there were.
    ///
    /// # Errors
    /// When there are no such two objects or the graph cannot be solved; nothing has changed then.
    pub fn split(&mut self, from: ObjectId, into: ObjectId) -> Result<usize, MergeError> {
        if from == into {
            return Err(MergeError::Same(from));
        }
        let (from_at, into_at) = (self.known(from)?, self.known(into)?);
        let before = (self.objects[from_at].clone(), self.objects[into_at].clone());
        let mut other = before.1.clone();
        let moved = self.objects[from_at].yield_to(&mut self.graph, &mut other, &self.slam);
        self.objects[into_at] = other;
        match self.solved(moved) {
            Ok((count, forgotten)) => {
                self.chain.note_loose(forgotten);
                self.refresh([into_at, from_at].into_iter());
                Ok(count)
            }
            Err(why) => {
                (self.objects[from_at], self.objects[into_at]) = before;
                Err(why)
            }
        }
    }

    fn forget_neighbour(&mut self, gone: ObjectId) {
        for object in &mut self.objects {
            object.company.beside.remove(&gone);
        }
    }

    /// Solves the graph after a change of its factors; where that fails, the graph is as it was.
    pub(super) fn solved<T>(&mut self, changed: Result<T, NoiseError>) -> Result<T, MergeError> {
        let changed = changed.map_err(|why| why.to_string());
        let solved = changed
            .and_then(|change| self.graph.update().map(|_| change).map_err(|why| why.to_string()));
        solved.map_err(|why| {
            self.graph.discard();
            MergeError::Graph(why)
        })
    }

    fn known(&self, id: ObjectId) -> Result<usize, MergeError> {
        self.position(id).ok_or(MergeError::Unknown(id))
    }

    /// Where an object is in the list.
    pub(super) fn position(&self, id: ObjectId) -> Option<usize> {
        self.objects.iter().position(|object| object.id == id)
    }
}

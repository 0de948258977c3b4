//! One object out of two, and objects that are no more.

use super::{MapObject, ObjectId, ObjectMap};
use thiserror::Error;

/// Why objects could not be merged or removed. The map is as it was.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum MergeError {
    /// There is no such object.
    #[error("there is no object {0} in the map")]
    Unknown(ObjectId),
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
    /// When there are no such two objects or the graph cannot be solved; nothing has changed then.
    pub fn merge(&mut self, kept: ObjectId, gone: ObjectId) -> Result<(), MergeError> {
        if kept == gone {
            return Err(MergeError::Same(kept));
        }
        let before = self.objects.clone();
        let other = self.take(gone)?;
        let Some(at) = self.position(kept) else {
            self.objects = before;
            return Err(MergeError::Unknown(kept));
        };
        let absorbed =
            self.objects[at].absorb(&mut self.graph, other, (&self.settings, &self.slam));
        let solved = absorbed
            .map_err(|why| why.to_string())
            .and_then(|()| self.graph.update().map_err(|why| why.to_string()));
        if let Err(why) = solved {
            self.graph.discard();
            self.objects = before;
            return Err(MergeError::Graph(why));
        }
        self.refresh([self.position(kept)].into_iter().flatten());
        Ok(())
    }

    /// Takes an object out of the map, with all its measurements.
    ///
    /// # Errors
    /// When there is no such object or the graph cannot be solved without it; nothing has changed then.
    pub fn remove(&mut self, id: ObjectId) -> Result<(), MergeError> {
        let before = self.objects.clone();
        self.take(id)?.leave(&mut self.graph);
        if let Err(why) = self.graph.update() {
            self.objects = before;
            return Err(MergeError::Graph(why.to_string()));
        }
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
        let at = self.position(into).ok_or(MergeError::Unknown(into))?;
        let before = self.objects.clone();
        let mut other = self.objects[at].clone();
        let Some(from_at) = self.position(from) else { return Err(MergeError::Unknown(from)) };
        let moved = self.objects[from_at].yield_to(&mut self.graph, &mut other, &self.slam);
        self.objects[at] = other;
        let solved = moved
            .map_err(|why| why.to_string())
            .and_then(|moved| self.graph.update().map(|_| moved).map_err(|why| why.to_string()));
        if solved.is_err() {
            self.graph.discard();
            self.objects = before;
        } else {
            self.refresh([at, from_at].into_iter());
        }
        solved.map_err(MergeError::Graph)
    }

    fn take(&mut self, id: ObjectId) -> Result<MapObject, MergeError> {
        let at = self.position(id).ok_or(MergeError::Unknown(id))?;
        Ok(self.objects.remove(at))
    }

    /// Where an object is in the list.
    pub(super) fn position(&self, id: ObjectId) -> Option<usize> {
        self.objects.iter().position(|object| object.id == id)
    }
}

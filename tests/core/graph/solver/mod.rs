//! The solver through its public interface, held to a dense reference.

mod agreement;
mod changes;
mod descent;
mod reference;
mod structure;
mod world;

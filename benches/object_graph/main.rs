//! How long a keyframe takes in the object graph, beside GTSAM's iSAM2 on an equivalent graph:
//! `cargo bench --bench object_graph -- --keyframes 10000`.
//!
//! Times are the processor's, of one thread each: other programs cost cache, but do not count.
//!
//! `--world building`, `--world lattice` or `--world round` takes one of the three, `--ours` leaves iSAM2 out, `--repeats` is the number of
//! runs.
#![expect(clippy::unwrap_used, reason = "a benchmark ends where something is not as it should be")]

#[path = "../../tests/command/environment.rs"]
mod environment;
mod closure;
mod isam2;
mod ours;
mod times;
mod world;

use times::Run;
use world::Keyframe;

const DEFAULT_KEYFRAMES: usize = 2000;
/// Both solvers do the same in each run. The least time of a keyframe counts.
const DEFAULT_REPEATS: usize = 3;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let after = |name: &str| {
        let at = arguments.iter().position(|a| a == name)?;
        arguments.get(at + 1)
    };
    let number = |name: &str, default| after(name).map_or(default, |n| n.parse().unwrap());
    let keyframes = number("--keyframes", DEFAULT_KEYFRAMES);
    let repeats = number("--repeats", DEFAULT_REPEATS);
    let is_wanted = |name: &str| after("--world").is_none_or(|wanted| wanted == name);
    let is_alone = arguments.iter().any(|a| a == "--ours");
    for (name, make) in WORLDS.iter().filter(|(name, _)| is_wanted(name)) {
        compare(name, &make(keyframes), repeats, is_alone);
    }
    if is_wanted("round") {
        closure::close(keyframes);
    }
}

type World = fn(usize) -> Vec<Keyframe>;
const WORLDS: [(&str, World); 2] = [("building", world::building), ("lattice", world::lattice)];

fn compare(name: &str, world: &[Keyframe], repeats: usize, is_alone: bool) {
    let settling = times::settling(world);
    let objects = world.iter().flat_map(|k| &k.seen).map(|s| s.object + 1).max().unwrap_or(0);
    let closures = world::closures(world).iter().filter(|is_closure| **is_closure).count();
    println!(
        "{name}: {} keyframes, {objects} objects, {closures} keyframes with closures",
        world.len()
    );
    let (ours, effort) = ours::drive(world, repeats);
    ours.print("ours", &settling);
    println!("  {effort}");
    if is_alone {
        return;
    }
    match isam2::drive(world, repeats) {
        Ok(theirs) => {
            theirs.print("iSAM2", &settling);
            print_ratios(&ours, &theirs, &settling);
        }
        Err(reason) => println!("  iSAM2 was not run: {reason}"),
    }
}

/// Above 1 where ours is faster.
fn print_ratios(ours: &Run, theirs: &Run, settling: &[bool]) {
    let (mine, other) = (ours.summary(settling), theirs.summary(settling));
    println!(
        "  iSAM2 / ours: total {:.2}, p50 {:.2}, p99 {:.2}, max {:.2}; away from closures: p50 {:.2}, p99 {:.2}",
        other.total / mine.total,
        other.all.p50 / mine.all.p50,
        other.all.p99 / mine.all.p99,
        other.all.max / mine.all.max,
        other.away.p50 / mine.away.p50,
        other.away.p99 / mine.away.p99,
    );
}

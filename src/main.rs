//! Arguments in, exit code out.

use std::process::ExitCode;

fn main() -> ExitCode {
    ellipsoid_slam::cli::run()
}

//! The benchmark runner, in the order of a run.
//!
//! [`suites`] finds what was asked for, [`cases`] makes a list of it and checks each scene before
//! anything is timed, [`filled`] makes models that a suite fills, [`measure`] times one case, with points of [`generated`] where the suite says so,
//! [`report`] is what `--json` writes, [`table`] and [`plot`] show it, and [`changes`] holds it against an
//! earlier report.

pub mod cases;
pub mod changes;
pub mod filled;
pub mod generated;
pub mod measure;
pub mod plot;
pub mod report;
pub mod suites;
pub mod table;

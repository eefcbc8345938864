//! What `bench --json` writes.

use crate::bench::changes::Comparison;
use crate::engine::Engine;
use crate::stats::Row;
use crate::threads;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};
use std::fs;

/// One run of the runner.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(title = "pointillist bench --json")]
pub struct Report {
    /// Name of the device.
    pub device: String,
    /// Its driver with version; empty on the CPU reference.
    pub driver: String,
    /// The processor, or at least its architecture.
    pub cpu: String,
    /// Threads that computed: as many as `--threads` says, or as the processor offers to this process.
    pub threads: Option<usize>,
    /// Version of pointillist.
    pub version: &'static str,
    /// What the binary was built from, where git knew.
    pub commit: Option<&'static str>,
    /// Frames of each row, after one to warm up.
    pub runs: u32,
    /// Whether all that was asked for was measured or skipped: not while the runner is at it, nor after an interruption or
    /// a failure.
    pub complete: bool,
    /// What was measured.
    pub rows: Vec<Row>,
    /// What was not.
    pub skipped: Vec<Skipped>,
    /// What differs from an earlier report, where one was given.
    pub comparison: Option<Comparison>,
}

/// A row of a suite that was not measured.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Skipped {
    /// As it would stand in a row.
    pub name: String,
    /// The suite.
    pub suite: String,
    /// Why, and what to do about it.
    pub reason: String,
}

impl Report {
    /// Without rows yet.
    pub fn new(engine: &Engine, runs: u32) -> Self {
        Self {
            device: engine.name(),
            driver: engine.driver(),
            cpu: cpu(),
            threads: Some(threads::count()),
            version: env!("CARGO_PKG_VERSION"),
            commit: option_env!("POINTILLIST_COMMIT"),
            runs,
            complete: false,
            rows: Vec::new(),
            skipped: Vec::new(),
            comparison: None,
        }
    }
}

/// The JSON Schema of what `bench --json` writes.
pub fn json_schema() -> Value {
    let schema = schemars::schema_for!(Report);
    serde_json::to_value(schema).unwrap_or_else(|_| json!({}))
}

/// The processor's name, or at least its architecture.
fn cpu() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == "model name").then(|| value.trim().to_owned())
    });
    model.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

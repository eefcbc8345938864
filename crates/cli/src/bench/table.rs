//! Tables of a report: aligned for a terminal, or as Markdown.

use crate::bench::report::Report;
use crate::stats::Row;
use std::fmt::Write;

/// Titles, and one list of cells a row.
pub struct Table {
    titles: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

/// A column of a table of rows: its title, and what a row has there.
type Column = (&'static str, fn(&Row) -> Option<String>);

const COLUMNS: &[Column] = &[
    ("scene", |row| Some(row.name.clone())),
    ("points", |row| Some(row.points.to_string())),
    ("size", |row| Some(format!("{}x{}", row.size[0], row.size[1]))),
    ("trace ms", |row| Some(short(row.trace_ms.median))),
    ("min", |row| Some(short(row.trace_ms.min))),
    ("max", |row| Some(short(row.trace_ms.max))),
    ("frames/s", |row| Some(short(row.frames_per_second))),
    ("paper frames/s", |row| row.paper_frames_per_second.map(short)),
    ("march ms", |row| kernels_of(row, "march")),
    ("isosurface ms", |row| kernels_of(row, "isosurface")),
    ("wall ms", |row| Some(short(row.wall_ms.median))),
    ("build ms", |row| Some(short(row.build_ms.median))),
    ("plan + build over", |row| {
        row.prepared_over.as_ref().map(|over| format!("{} × {}", short(over.ratio), over.name))
    }),
    ("trace ×", |row| row.beside.as_ref().map(|it| short(it.trace_ratio))),
    ("build ×", |row| row.beside.as_ref().map(|it| short(it.build_ratio))),
    ("FLIP", |row| row.beside.as_ref().map(|it| format!("{:.4}", it.flip))),
    ("pixels differ", |row| row.beside.as_ref().map(|it| format!("{:.1} %", 100.0 * it.differing))),
    ("Mrays/s", |row| Some(short(row.rays_per_second.all / 1e6))),
    ("tests/ray", |row| Some(short(row.tests_per_ray))),
    ("bytes/point", |row| Some(short(row.bytes_per_point))),
    ("passes", |row| Some(row.passes.to_string())),
];

/// What the first table leaves out: rays and their speed by kind, and what is not of a frame.
const DETAILS: &[Column] = &[
    ("scene", |row| Some(row.name.clone())),
    ("camera rays", |row| Some(row.rays.camera.to_string())),
    ("Mrays/s", |row| row.rays_per_second.camera.map(mega)),
    ("shadow", |row| some(row.rays.shadow)),
    ("Mrays/s", |row| row.rays_per_second.shadow.map(mega)),
    ("reflected", |row| some(row.rays.reflected)),
    ("refracted", |row| some(row.rays.refracted)),
    ("scattered", |row| some(row.rays.scattered)),
    ("Mrays/s", |row| row.rays_per_second.scattered.map(mega)),
    ("GPU ms", |row| row.gpu_ms.map(|ms| short(ms.median))),
    ("min", |row| row.gpu_ms.map(|ms| short(ms.min))),
    ("max", |row| row.gpu_ms.map(|ms| short(ms.max))),
    ("build min", |row| Some(short(row.build_ms.min))),
    ("max", |row| Some(short(row.build_ms.max))),
    ("on the CPU ms", |row| row.cpu_preparation_ms.map(|ms| short(ms.median))),
    ("builds", |row| Some(row.builds.to_string())),
    ("read ms", |row| Some(short(row.read_ms))),
    ("plan ms", |row| Some(short(row.plan_ms))),
    ("pipelines ms", |row| Some(short(row.pipelines_ms))),
    ("warm-up ms", |row| row.warm_up_ms.map(short)),
    ("picture", |row| Some(row.pixels.clone())),
];

impl Table {
    /// From titles and cells.
    pub fn new(titles: Vec<&'static str>, rows: Vec<Vec<String>>) -> Self {
        Self { titles, rows }
    }

    /// Of those columns that any row has something in.
    fn of_rows(columns: &[Column], rows: &[Row]) -> Self {
        let used: Vec<&Column> = columns
            .iter()
            .filter(|column| rows.is_empty() || rows.iter().any(|row| column.1(row).is_some()))
            .collect();
        let cells =
            |row: &Row| used.iter().map(|column| column.1(row).unwrap_or_default()).collect();
        Self::new(used.iter().map(|column| column.0).collect(), rows.iter().map(cells).collect())
    }

    /// Columns as wide as their longest cell, the first to the left, numbers to the right.
    pub fn text(&self) -> String {
        let titles: Vec<String> = self.titles.iter().map(|&title| title.to_owned()).collect();
        let lines = || std::iter::once(&titles).chain(&self.rows);
        let width = |column: usize| lines().map(|line| line[column].chars().count()).max();
        let widths: Vec<usize> = (0..titles.len()).filter_map(width).collect();
        let mut text = String::new();
        for line in lines() {
            let mut joined = String::new();
            for (at, (cell, &width)) in line.iter().zip(&widths).enumerate() {
                // Writing to a string cannot fail; nor below.
                let _ = match at {
                    0 => write!(joined, "{cell:<width$}"),
                    _ => write!(joined, "  {cell:>width$}"),
                };
            }
            text.push_str(joined.trim_end());
            text.push('\n');
        }
        text
    }

    /// The same for Markdown.
    pub fn markdown(&self) -> String {
        let escaped =
            |cell: &String| cell.replace('\\', "\\\\").replace('|', "\\|").replace('\n', " ");
        let mut text = format!("| {} |\n", self.titles.join(" | "));
        let _ = writeln!(text, "|---|{}", "---:|".repeat(self.titles.len() - 1));
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(escaped).collect();
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        }
        text
    }
}

/// The report for a terminal.
pub fn text(report: &Report) -> String {
    let mut text = format!("{}\n", heading(report));
    if !report.rows.is_empty() {
        text += &Table::of_rows(COLUMNS, &report.rows).text();
        text += "\n";
        text += &Table::of_rows(DETAILS, &report.rows).text();
    }
    for skipped in &report.skipped {
        let _ = writeln!(text, "skipped: {}: {}", skipped.name, skipped.reason);
    }
    if let Some(comparison) = &report.comparison {
        let _ = write!(text, "\n{}\n{}", comparison.heading(), comparison.table().text());
    }
    text
}

/// The report as a part of a Markdown page.
pub fn markdown(report: &Report) -> String {
    let mut text = format!("{}\n", heading(report));
    if !report.rows.is_empty() {
        for columns in [COLUMNS, DETAILS] {
            let _ = write!(text, "\n{}", Table::of_rows(columns, &report.rows).markdown());
        }
    }
    if !report.skipped.is_empty() {
        text.push_str("\nSkipped:\n\n");
    }
    for skipped in &report.skipped {
        let _ = writeln!(text, "* {}: {}", skipped.name, skipped.reason.replace('\n', " "));
    }
    if let Some(comparison) = &report.comparison {
        let _ = write!(text, "\n{}\n\n{}", comparison.heading(), comparison.table().markdown());
    }
    text
}

fn heading(report: &Report) -> String {
    let driver = match report.driver.as_str() {
        "" => String::new(),
        driver => format!(", {driver}"),
    };
    let threads = report.threads.map_or_else(String::new, |threads| format!(", {threads} threads"));
    let commit = report.commit.map_or_else(String::new, |commit| format!(", commit {commit}"));
    let runs = match report.runs {
        1 => "1 run".to_owned(),
        runs => format!("{runs} runs"),
    };
    let incomplete = if report.complete { "" } else { "; incomplete: the run ended early" };
    format!(
        "{}{driver}; {}{threads}; pointillist {}{commit}; {runs} after one to warm up{incomplete}",
        report.device, report.cpu, report.version
    )
}

/// Of the last frame, all kernels of such a name: through volumes, of which a scene may have none.
fn kernels_of(row: &Row, name: &str) -> Option<String> {
    let own = row.kernels.iter().filter(|(kernel, _)| kernel.starts_with(name));
    let ms: Vec<f64> = own.map(|(_, &ms)| ms).collect();
    (!ms.is_empty()).then(|| short(ms.iter().sum()))
}

fn some(count: u64) -> Option<String> {
    (count > 0).then(|| count.to_string())
}

fn mega(per_second: f64) -> String {
    short(per_second / 1e6)
}

/// A number to about three digits.
pub fn short(number: f64) -> String {
    match number.abs() {
        size if size < 0.995 => format!("{number:.3}"),
        size if size < 9.95 => format!("{number:.2}"),
        _ => format!("{number:.1}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let cells = |name: &str, ms: &str| vec![name.to_owned(), ms.to_owned()];
        Table::new(vec!["scene", "ms"], vec![cells("a | b", "1.50"), cells("long name", "10.0")])
    }

    #[test]
    fn columns_are_aligned_for_a_terminal() {
        assert_eq!(table().text(), "scene        ms\na | b      1.50\nlong name  10.0\n");
    }

    #[test]
    fn markdown_has_as_many_cells_in_every_row_whatever_a_name_holds() {
        assert_eq!(
            table().markdown(),
            "| scene | ms |\n|---|---:|\n| a \\| b | 1.50 |\n| long name | 10.0 |\n"
        );
    }

    #[test]
    fn numbers_have_about_three_digits() {
        let shown = [0.0, 0.04321, 0.99, 1.0, 9.949, 9.96, 123.44, 12345.6].map(short);
        assert_eq!(shown, ["0.000", "0.043", "0.990", "1.00", "9.95", "10.0", "123.4", "12345.6"]);
    }
}

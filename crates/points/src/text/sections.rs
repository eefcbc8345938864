//! What stands between the tables of one file, and after them.

use crate::meaning::printable;
use crate::text::head::{self, Kind};
use crate::text::tecplot;

/// What is to become of the lines that come.
pub(super) struct Between {
    kind: Kind,
    state: State,
    /// Rows of the zone that were read.
    rows: u64,
    /// The record of a zone that begins.
    zone: String,
    /// Names of sections that were passed over, each once.
    passed_over: Vec<String>,
    /// Whether other frames follow the one that was read.
    more_frames: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    /// Rows.
    Table,
    /// The names of columns, which are those of the first table.
    Names,
    /// What is passed over until a section or zone begins.
    Other,
    /// The record of a zone.
    Zone,
}

impl Between {
    pub(super) fn new(kind: Kind) -> Self {
        Self {
            kind,
            state: State::Table,
            rows: 0,
            zone: String::new(),
            passed_over: Vec::new(),
            more_frames: false,
        }
    }

    /// Whether a line is passed over. It may begin a section or a zone.
    pub(super) fn passes_over(&mut self, line: &[u8]) -> bool {
        match self.kind {
            Kind::Sections => {
                if let Some(name) = head::section_of(line) {
                    self.section(name);
                    return true;
                }
                match self.state {
                    State::Names => self.state = State::Table,
                    State::Table => return false,
                    State::Other | State::Zone => (),
                }
                true
            }
            Kind::Zones(_) => self.passes_over_in_zones(line),
            Kind::Plain | Kind::Molecule => false,
        }
    }

    fn section(&mut self, name: &[u8]) {
        self.state = if head::is_data(name) { State::Names } else { State::Other };
        let name = printable(&String::from_utf8_lossy(name));
        // The name of a table is no table.
        let is_known = self.passed_over.contains(&name) || name.eq_ignore_ascii_case("name");
        if self.state == State::Other && !is_known {
            self.passed_over.push(name);
        }
    }

    fn passes_over_in_zones(&mut self, line: &[u8]) -> bool {
        if tecplot::is_zone(line) {
            (self.state, self.rows) = (State::Zone, 0);
            self.zone.clear();
        }
        if self.state == State::Zone {
            if !head::is_row(line) {
                self.zone += &String::from_utf8_lossy(line).to_uppercase();
                self.zone.push(' ');
                return true;
            }
            self.state = State::Table;
            self.kind = Kind::Zones(tecplot::nodes_of(&self.zone));
        }
        match self.kind {
            Kind::Zones(Some(nodes)) if self.rows >= nodes => {
                self.state = State::Other;
                let cells = "cells of zones".to_owned();
                if !self.passed_over.contains(&cells) {
                    self.passed_over.push(cells);
                }
                true
            }
            _ => false,
        }
    }

    pub(super) fn saw_row(&mut self) {
        self.rows += 1;
    }

    /// Whether a line that is no row, after so many rows, ends what is read.
    pub(super) fn is_end(&mut self, line: &[u8], found: u64, declared: Option<u64>) -> bool {
        let is_count = head::count_of(line).is_some();
        self.more_frames = self.kind == Kind::Molecule && is_count && declared == Some(found);
        self.more_frames
    }

    /// What was passed over.
    pub(super) fn note(&self) -> Option<String> {
        if self.more_frames {
            return Some("only the first of several frames was read".to_owned());
        }
        match self.passed_over.as_slice() {
            [] => None,
            names => Some(format!("passed over: {}", names.join(", "))),
        }
    }
}

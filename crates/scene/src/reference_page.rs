//! The tables of docs/scene.md, written from the table of keys.

use crate::keys::{Absent, Key, Kind, SCENE, Table};
use crate::not_built::not_built;
use std::fmt::Write;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scene.md");
const BEGIN: &str = "<!-- keys: written by `ACCEPT=1 cargo test -p pointillist-scene page` -->\n";
const END: &str = "<!-- end of keys -->\n";

/// A section of every table, outermost first.
fn tables() -> String {
    let mut out = String::new();
    for key in SCENE.keys {
        section(key, key.name, &mut out);
    }
    out
}

fn section(key: &Key, path: &str, out: &mut String) {
    let (Kind::Table(table) | Kind::Tables { table, .. }) = key.kind else { return };
    write(table, path, out).unwrap();
    for inner in table.keys {
        section(inner, &format!("{path}.{}", inner.name), out);
    }
}

fn write(table: &Table, path: &str, out: &mut String) -> std::fmt::Result {
    writeln!(out, "\n### `{}`\n\n{}", table.header, table.doc)?;
    let whole = not_built(path).is_some();
    if whole {
        writeln!(out, "\nNot built yet.")?;
    }
    writeln!(out, "\n| key | meaning | value | default | built |\n|---|---|---|---|---|")?;
    for key in table.keys {
        let path = format!("{path}.{}", key.name);
        let absent = match key.absent {
            Absent::Required(_) => "required".into(),
            Absent::Value(text) => format!("`{text}`"),
            Absent::Words(words, _) => words.into(),
            Absent::Table => "its keys' defaults".into(),
        };
        let of = key.only.map_or(String::new(), |only| format!("`{only}` only. "));
        let built = if whole || not_built(&path).is_some() { "not built yet" } else { "yes" };
        let (name, doc, value) = (key.name, key.doc, key.kind.expected());
        writeln!(out, "| `{name}` | {of}{doc} | {value} | {absent} | {built} |")?;
    }
    Ok(())
}

#[test]
fn reference_page_states_every_key_as_it_is_checked() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let (before, rest) = page.split_once(BEGIN).expect("docs/scene.md lost its first marker");
    let (shown, after) = rest.split_once(END).expect("docs/scene.md lost its second marker");
    let written = format!("{}\n", tables());
    if std::env::var_os("ACCEPT").is_some() {
        std::fs::write(PAGE, format!("{before}{BEGIN}{written}{END}{after}")).unwrap();
    } else {
        assert_eq!(shown, written, "to accept: ACCEPT=1 cargo test -p pointillist-scene page");
    }
}

/// The example at the top of the page is what a reader copies first.
#[test]
fn first_example_of_the_reference_page_is_a_scene() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next());
    let scene = crate::Scene::from_toml(example.unwrap(), "page.toml".as_ref(), &[]);
    assert_eq!(scene.map(|scene| scene.objects.len()), Ok(1));
}

//! Host structs and constants against what the compiled kernels say.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use kernels::{layout, source, spirv};
use rspirv::binary::Disassemble;
use rspirv::dr::{Module, Operand};
use rspirv::spirv::{Decoration, ExecutionMode, Op};
use std::collections::{BTreeMap, BTreeSet};

fn module(name: &str) -> Module {
    let words = spirv::by_name(name).expect("a module for every name");
    rspirv::dr::load_words(words).expect("a module that parses")
}

type Members = Vec<(String, usize)>;

/// Structs of a module that have member offsets: name → members in order, with their offsets.
fn structs_with_offsets(module: &Module) -> Vec<(String, Members)> {
    let mut names = BTreeMap::new();
    let mut members: BTreeMap<u32, BTreeMap<u32, (String, Option<usize>)>> = BTreeMap::new();
    for line in &module.debug_names {
        match (line.class.opcode, line.operands.as_slice()) {
            (Op::Name, [Operand::IdRef(id), Operand::LiteralString(name)]) => {
                names.insert(*id, name.clone());
            }
            (
                Op::MemberName,
                [Operand::IdRef(id), Operand::LiteralBit32(at), Operand::LiteralString(name)],
            ) => {
                members.entry(*id).or_default().insert(*at, (name.clone(), None));
            }
            _ => {}
        }
    }
    for line in &module.annotations {
        if let [
            Operand::IdRef(id),
            Operand::LiteralBit32(at),
            Operand::Decoration(Decoration::Offset),
            Operand::LiteralBit32(offset),
        ] = line.operands.as_slice()
            && let Some(member) = members.get_mut(id).and_then(|all| all.get_mut(at))
        {
            member.1 = Some(*offset as usize);
        }
    }
    members
        .into_iter()
        .filter_map(|(id, all)| {
            let all: Option<Members> =
                all.into_values().map(|(name, offset)| Some((name, offset?))).collect();
            Some((names.get(&id)?.clone(), all?))
        })
        .collect()
}

#[test]
fn layout_matches_spirv() {
    let mut seen = BTreeSet::new();
    for kernel in spirv::NAMES {
        for (name, members) in structs_with_offsets(&module(kernel)) {
            let Some(host) = layout::STRUCTS.iter().find(|host| host.name == name) else {
                continue; // the block around a runtime array
            };
            let host: Members =
                host.members.iter().map(|&(member, at)| (member.to_owned(), at)).collect();
            assert_eq!(host, members, "{name}: host (left) and {kernel}.spv (right)");
            seen.insert(name);
        }
    }
    let all: BTreeSet<String> = layout::STRUCTS.iter().map(|s| s.name.to_owned()).collect();
    assert_eq!(seen, all, "structs that kernels use (left) and that the host lists (right)");
}

#[test]
fn constants_match_the_host() {
    let path = source::glsl_folder().join("shared/layout.glsl");
    let text = std::fs::read_to_string(path).expect("layout.glsl");
    let mut defined = BTreeMap::new();
    for line in text.lines().filter_map(|line| line.strip_prefix("#define ")) {
        let mut words = line.split_whitespace();
        let name = words.next().expect("a name after #define");
        if let Some(value) = words.next() {
            let value = value.trim_end_matches('u');
            let value = match value.strip_prefix("0x") {
                Some(digits) => u32::from_str_radix(digits, 16),
                None => value.parse(),
            };
            defined.insert(name, value.expect("an unsigned number"));
        }
    }
    let host: BTreeMap<&str, u32> = layout::CONSTANTS.iter().copied().collect();
    assert_eq!(host, defined, "host (left) and layout.glsl (right)");
}

/// The bindings a pass gives are checked where it records; here, that none lies past the host's.
#[test]
fn group_sizes_and_bindings_match_the_host() {
    for kernel in spirv::NAMES {
        let module = module(kernel);
        let size: Vec<u32> = module
            .execution_modes
            .iter()
            .filter(|mode| {
                mode.operands.contains(&Operand::ExecutionMode(ExecutionMode::LocalSize))
            })
            .flat_map(|mode| mode.operands.iter())
            .filter_map(|operand| match operand {
                Operand::LiteralBit32(size) => Some(*size),
                _ => None,
            })
            .collect();
        let over_pixels = ["accumulate", "camera_rays", "camera_trace", "disc_trace"]
            .contains(&spirv::source_of(kernel).0);
        let group = if over_pixels { layout::TILE_GROUP } else { layout::LINE_GROUP };
        assert_eq!(size, [group, 1, 1], "{kernel}: workgroup");
        for line in &module.annotations {
            if let [_, Operand::Decoration(Decoration::Binding), Operand::LiteralBit32(binding)] =
                line.operands.as_slice()
            {
                assert!(*binding <= layout::SHADOW_PATHS, "{kernel}: binding {binding}");
            }
        }
    }
}

/// A float operation that a driver may fuse is a pixel that differs from the twin.
#[test]
fn every_float_operation_is_exact() {
    for kernel in spirv::NAMES {
        let module = module(kernel);
        let exact: BTreeSet<u32> = module
            .annotations
            .iter()
            .filter(|line| line.operands.contains(&Operand::Decoration(Decoration::NoContraction)))
            .filter_map(|line| match line.operands.first() {
                Some(Operand::IdRef(id)) => Some(*id),
                _ => None,
            })
            .collect();
        let mut count = 0;
        for line in module.all_inst_iter() {
            let float = matches!(
                line.class.opcode,
                Op::FAdd | Op::FSub | Op::FMul | Op::FDiv | Op::FNegate | Op::VectorTimesScalar
            );
            if float {
                count += 1;
                let id = line.result_id.expect("a result");
                assert!(exact.contains(&id), "{kernel}: {}", line.disassemble());
            }
        }
        assert!(count > 0 || exact.is_empty(), "{kernel}: decorations without operations");
    }
}

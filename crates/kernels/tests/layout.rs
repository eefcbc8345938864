//! Host structs and constants against what the compiled kernels say.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use kernels::{layout, spirv};
use rspirv::binary::Disassemble;
use rspirv::dr::{Module, Operand};
use rspirv::spirv::{Decoration, ExecutionMode, Op};
use std::collections::{BTreeMap, BTreeSet};

fn modules() -> impl Iterator<Item = (&'static spirv::Module, Module)> {
    let parsed = |module: &'static spirv::Module| {
        let words = rspirv::dr::load_words(module.words());
        (module, words.expect("a module that parses"))
    };
    spirv::modules().values().map(parsed)
}

type Members = Vec<(String, usize)>;

/// Structs of a module that have member offsets: name, members in order with their
/// offsets, and whether it is a block of an interface.
fn structs_with_offsets(module: &Module) -> Vec<(String, Members, bool)> {
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
    let is_block = |line: &&rspirv::dr::Instruction| {
        line.operands.iter().any(|operand| {
            matches!(operand, Operand::Decoration(Decoration::Block | Decoration::BufferBlock))
        })
    };
    let blocks: BTreeSet<u32> = module
        .annotations
        .iter()
        .filter(is_block)
        .filter_map(|line| line.operands.first().and_then(Operand::id_ref_any))
        .collect();
    members
        .into_iter()
        .filter_map(|(id, all)| {
            let all: Option<Members> =
                all.into_values().map(|(name, offset)| Some((name, offset?))).collect();
            Some((names.get(&id)?.clone(), all?, blocks.contains(&id)))
        })
        .collect()
}

#[test]
fn layout_matches_spirv() {
    let mut seen = BTreeSet::new();
    for (kernel, module) in modules() {
        for (name, members, is_block) in structs_with_offsets(&module) {
            let Some(host) = layout::structs().find(|host| host.name == name) else {
                assert!(is_block, "{}: the host has no struct {name}", kernel.name());
                continue; // the block around a runtime array
            };
            let host: Members =
                host.members.iter().map(|of| (of.name.to_owned(), of.offset)).collect();
            assert_eq!(host, members, "{name}: host (left) and {}.spv (right)", kernel.name());
            seen.insert(name);
        }
    }
    let all: BTreeSet<String> = layout::structs().map(|of| of.name.to_owned()).collect();
    assert_eq!(seen, all, "structs that kernels use (left) and that the host lists (right)");
}

/// Every binding is one that the host knows, and every one that it knows some kernel uses.
#[test]
fn group_sizes_and_bindings_match_the_host() {
    let mut used = BTreeSet::new();
    for (kernel, module) in modules() {
        let name = kernel.name();
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
        let over_pixels = ["accumulate", "camera_rays", "camera_trace"].contains(&kernel.kernel());
        let group = if over_pixels { layout::TILE_GROUP } else { layout::LINE_GROUP };
        assert_eq!(size, [group, 1, 1], "{name}: workgroup");
        for line in &module.annotations {
            if let [_, Operand::Decoration(Decoration::Binding), Operand::LiteralBit32(number)] =
                line.operands.as_slice()
            {
                let known = layout::binding(*number);
                used.insert(known.unwrap_or_else(|| panic!("{name}: binding {number}")).name);
            }
        }
    }
    let all: BTreeSet<&str> = layout::bindings().map(|of| of.name).collect();
    assert_eq!(used, all, "bindings that kernels use (left) and that the host lists (right)");
}

/// A list is of the struct that the host says, and an image where it says so.
#[test]
fn what_is_bound_is_what_the_host_says() {
    let mut compared = 0;
    for (kernel, module) in modules() {
        let instruction =
            |id: u32| module.types_global_values.iter().find(|line| line.result_id == Some(id));
        let operand = |line: &rspirv::dr::Instruction, at: usize| {
            line.operands.get(at).and_then(Operand::id_ref_any)
        };
        let names: BTreeMap<u32, &str> = module
            .debug_names
            .iter()
            .filter_map(|line| match line.operands.as_slice() {
                [Operand::IdRef(id), Operand::LiteralString(name)] => Some((*id, name.as_str())),
                _ => None,
            })
            .collect();
        for line in &module.annotations {
            let &[
                Operand::IdRef(variable),
                Operand::Decoration(Decoration::Binding),
                Operand::LiteralBit32(number),
            ] = line.operands.as_slice()
            else {
                continue;
            };
            let host = layout::binding(number).expect("a binding of the host");
            let what = format!("{}: {}", kernel.name(), host.name);
            let pointer = instruction(variable).and_then(|line| line.result_type);
            let pointee = pointer.and_then(instruction).and_then(|line| operand(line, 1));
            let bound = pointee.and_then(instruction).expect("a type");
            match bound.class.opcode {
                // The first image of a ray state has the binding of the queue.
                Op::TypeImage => {
                    let is_state = [layout::STATE_IN, layout::STATE_OUT].contains(&number);
                    assert!(host.element.is_none() || is_state, "{what}: an image");
                }
                Op::TypeStruct => {
                    let member = operand(bound, 0).and_then(instruction).expect("a member");
                    let element = match member.class.opcode {
                        Op::TypeRuntimeArray => operand(member, 0),
                        _ => member.result_id,
                    };
                    let is_struct = element
                        .and_then(instruction)
                        .is_some_and(|line| line.class.opcode == Op::TypeStruct);
                    let name = element.filter(|_| is_struct).and_then(|id| names.get(&id).copied());
                    match host.element {
                        Some(layout::Type::Struct(expected)) => {
                            assert_eq!(name, Some(expected.name), "{what}");
                            compared += 1;
                        }
                        Some(layout::Type::Numbers(..)) => assert_eq!(name, None, "{what}"),
                        None => panic!("{what}: a buffer, and the host has an image"),
                    }
                }
                _ => assert!(host.reader.is_some(), "{what}: texels without a reader"),
            }
        }
    }
    assert!(compared > 100, "{compared} lists of structs");
}

/// A float operation that a driver may fuse is a pixel that differs from the twin.
#[test]
fn every_float_operation_is_exact() {
    for (kernel, module) in modules() {
        let kernel = kernel.name();
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
            if kernels::FLOAT_ARITHMETIC.contains(&(line.class.opcode as u32)) {
                count += 1;
                let id = line.result_id.expect("a result");
                assert!(exact.contains(&id), "{kernel}: {}", line.disassemble());
            }
        }
        assert!(count > 0 || exact.is_empty(), "{kernel}: decorations without operations");
    }
}

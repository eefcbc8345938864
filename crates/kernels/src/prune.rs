//! Takes out of a module the buffers and images that nothing in it uses.
//!
//! A stage's file declares all that its kernels may read; a kernel's module then lists what it does read, which is what a pass
//! has to bind. Drivers' optimisers would take the others out too, but only after they had to be bound.

use std::collections::HashSet;

const HEADER_WORDS: usize = 5;
/// SPIR-V 1.3: from 1.4 on, entry points list resources too.
const LATEST: u32 = 0x0001_0300;
const OP_NAME: u32 = 5;
const OP_VARIABLE: u32 = 59;
const OP_DECORATE: u32 = 71;
const OP_FUNCTION: u32 = 54;
/// `UniformConstant` and `StorageBuffer`, and `Uniform`, as which SPIR-V before 1.3 has storage buffers.
const RESOURCES: [u32; 3] = [0, 2, 12];

/// The same module without resources that no function names. Words that are no module come back as they are.
#[must_use]
pub fn without_unused(module: &[u32]) -> Vec<u32> {
    let Some(instructions) = instructions(module) else { return module.to_vec() };
    if module[1] > LATEST {
        return module.to_vec();
    }
    let body = instructions.iter().position(|of| of[0] & 0xffff == OP_FUNCTION);
    let body = &instructions[body.unwrap_or(instructions.len())..];
    // Literals may look like ids: what seems used for one stays, which harms nothing.
    let used: HashSet<u32> = body.iter().flat_map(|of| &of[1..]).copied().collect();
    let is_unused = |of: &&&[u32]| {
        of[0] & 0xffff == OP_VARIABLE && RESOURCES.contains(&of[3]) && !used.contains(&of[2])
    };
    let unused: HashSet<u32> = instructions.iter().filter(is_unused).map(|of| of[2]).collect();
    let stays = |of: &&&[u32]| match of[0] & 0xffff {
        OP_VARIABLE => !unused.contains(&of[2]),
        OP_NAME | OP_DECORATE => !unused.contains(&of[1]),
        _ => true,
    };
    let head = module[..HEADER_WORDS].iter();
    head.chain(instructions.iter().filter(stays).copied().flatten()).copied().collect()
}

/// The instructions, each with its first word.
fn instructions(module: &[u32]) -> Option<Vec<&[u32]>> {
    let mut rest = module.get(HEADER_WORDS..)?;
    let mut all = Vec::new();
    while let Some(first) = rest.first() {
        let length = (first >> 16) as usize;
        if length == 0 || length > rest.len() {
            return None;
        }
        let (one, behind) = rest.split_at(length);
        all.push(one);
        rest = behind;
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn instruction(opcode: u32, operands: &[u32]) -> Vec<u32> {
        [&[((operands.len() as u32 + 1) << 16) | opcode], operands].concat()
    }

    #[test]
    fn what_no_function_names_goes_with_its_decorations() {
        let load = 61;
        let parts = [
            instruction(OP_DECORATE, &[70, 33, 1]),
            instruction(OP_DECORATE, &[71, 33, 2]),
            instruction(OP_VARIABLE, &[9, 70, 12]),
            instruction(OP_VARIABLE, &[9, 71, 12]),
            instruction(OP_FUNCTION, &[2, 80, 0, 3]),
            instruction(load, &[2, 81, 70]),
        ];
        let head = [0x0723_0203, 0x0001_0300, 0, 100, 0];
        let module = [&head[..], &parts.concat()].concat();
        let kept = [&parts[0][..], &parts[2], &parts[4], &parts[5]].concat();
        assert_eq!(without_unused(&module), [&head[..], &kept].concat());
        assert_eq!(without_unused(&[1, 2]), [1, 2]);
    }
}

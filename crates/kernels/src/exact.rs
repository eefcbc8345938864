//! Makes every float operation of a module exact: decorates it with `NoContraction`.
//!
//! Without it a driver may fuse a multiplication into an addition, or reorder a sum, and the bits
//! differ from the twin's. GLSL's `precise` does the same, but has to be remembered at every
//! variable and ends at function borders; here nothing can be forgotten.

const HEADER_WORDS: usize = 5;
const OP_DECORATE: u32 = 71;
const DECORATION_NO_CONTRACTION: u32 = 42;

/// `OpFNegate`, `OpFAdd`, `OpFSub`, `OpFMul`, `OpFDiv`, `OpFRem`, `OpFMod`, and the products of
/// vectors and matrices with scalars and one another (SPIR-V specification, 3.52.13).
pub const FLOAT_ARITHMETIC: [u32; 14] =
    [127, 129, 131, 133, 136, 140, 141, 142, 143, 144, 145, 146, 147, 148];

/// The same module with `NoContraction` on every float arithmetic instruction. Decorations that are
/// already there are not repeated. Words that are no module come back as they are.
#[must_use]
pub fn forbid_contraction(module: &[u32]) -> Vec<u32> {
    let mut results = Vec::new();
    let mut decorated = Vec::new();
    let mut insert_at = None;
    let mut at = HEADER_WORDS;
    while let Some(&first) = module.get(at) {
        let (length, opcode) = ((first >> 16) as usize, first & 0xffff);
        if length == 0 || at + length > module.len() {
            return module.to_vec();
        }
        let operand = |i: usize| module.get(at + i).copied();
        if opcode == OP_DECORATE {
            insert_at = Some(at);
            if operand(2) == Some(DECORATION_NO_CONTRACTION) {
                decorated.extend(operand(1));
            }
        } else if FLOAT_ARITHMETIC.contains(&opcode) {
            results.extend(operand(2));
        }
        at += length;
    }
    let Some(insert_at) = insert_at else { return module.to_vec() };
    let mut exact = module[..insert_at].to_vec();
    for result in results.into_iter().filter(|id| !decorated.contains(id)) {
        exact.extend([(3 << 16) | OP_DECORATE, result, DECORATION_NO_CONTRACTION]);
    }
    exact.extend_from_slice(&module[insert_at..]);
    exact
}

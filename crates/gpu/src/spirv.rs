//! What a SPIR-V module says about itself: entry point, workgroup size, bindings, push constants.
//!
//! Reads just enough to bind what a kernel uses, to round a dispatch up to workgroups, and to know which bindings are only read, which is what keeps barriers away
//! between passes that share their input. It is no validator.

use crate::access::Access;
use crate::kernel::TexelType;
use std::collections::{HashMap, HashSet};
use std::ffi::CString;

/// What was found in a module.
#[derive(Debug)]
pub(crate) struct Reflection {
    /// Name of the one compute entry point.
    pub(crate) entry: CString,
    /// Invocations of a workgroup.
    pub(crate) group_size: [u32; 3],
    /// Its resources, in the order of their declarations.
    pub(crate) resources: Vec<Resource>,
    /// Bytes of its push constants.
    pub(crate) push_bytes: usize,
    /// Whether it has a specialization constant 0 or 1.
    pub(crate) is_specialized: bool,
    /// Whether its invocations vote in subgroups.
    pub(crate) votes: bool,
}

/// One variable with a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Resource {
    pub(crate) set: u32,
    pub(crate) binding: u32,
    pub(crate) kind: ResourceKind,
    pub(crate) access: Access,
}

/// The kinds this crate binds, and the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ResourceKind {
    StorageBuffer,
    StorageImage(TexelType),
    UniformTexelBuffer(TexelType),
    Other,
}

mod op {
    pub(super) const CAPABILITY: u16 = 17;
    pub(super) const ENTRY_POINT: u16 = 15;
    pub(super) const EXECUTION_MODE: u16 = 16;
    pub(super) const TYPE_INT: u16 = 21;
    pub(super) const TYPE_FLOAT: u16 = 22;
    pub(super) const TYPE_IMAGE: u16 = 25;
    pub(super) const TYPE_SAMPLED_IMAGE: u16 = 27;
    pub(super) const TYPE_VECTOR: u16 = 23;
    pub(super) const TYPE_ARRAY: u16 = 28;
    pub(super) const CONSTANT: u16 = 43;
    pub(super) const TYPE_STRUCT: u16 = 30;
    pub(super) const TYPE_POINTER: u16 = 32;
    pub(super) const SPEC_CONSTANT_COMPOSITE: u16 = 51;
    pub(super) const VARIABLE: u16 = 59;
    pub(super) const DECORATE: u16 = 71;
    pub(super) const MEMBER_DECORATE: u16 = 72;
}

mod decoration {
    pub(super) const SPEC_ID: u32 = 1;
    pub(super) const BUFFER_BLOCK: u32 = 3;
    pub(super) const ARRAY_STRIDE: u32 = 6;
    pub(super) const OFFSET: u32 = 35;
    pub(super) const BUILT_IN: u32 = 11;
    pub(super) const NON_WRITABLE: u32 = 24;
    pub(super) const BINDING: u32 = 33;
    pub(super) const DESCRIPTOR_SET: u32 = 34;
}

const MAGIC: u32 = 0x0723_0203;
const HEADER_WORDS: usize = 5;
const MODEL_GL_COMPUTE: u32 = 5;
const MODE_LOCAL_SIZE: u32 = 17;
const CAPABILITY_BALLOT: u32 = 64;
const CAPABILITY_SUBGROUP_BALLOT_KHR: u32 = 4423;
const BUILT_IN_WORKGROUP_SIZE: u32 = 25;
const STORAGE_UNIFORM_CONSTANT: u32 = 0;
const STORAGE_UNIFORM: u32 = 2;
const STORAGE_PUSH_CONSTANT: u32 = 9;
const STORAGE_STORAGE_BUFFER: u32 = 12;
const DIM_2D: u32 = 1;
const DIM_BUFFER: u32 = 5;
const IMAGE_SAMPLED: u32 = 1;
const IMAGE_STORAGE: u32 = 2;

/// What the types and decorations of a module say, by result id.
#[derive(Default)]
struct Declarations {
    scalars: HashMap<u32, TexelType>,
    images: HashMap<u32, ResourceKind>,
    /// Of scalars and vectors, in bytes.
    sizes: HashMap<u32, usize>,
    /// Elements, and the constant that says how many.
    arrays: HashMap<u32, [u32; 2]>,
    constants: HashMap<u32, u32>,
    strides: HashMap<u32, u32>,
    offsets: HashMap<(u32, u32), u32>,
    is_specialized: bool,
    struct_members: HashMap<u32, Vec<u32>>,
    buffer_blocks: HashSet<u32>,
    pointees: HashMap<u32, u32>,
    sets: HashMap<u32, u32>,
    bindings: HashMap<u32, u32>,
    non_writable: HashSet<u32>,
    non_writable_members: HashMap<u32, HashSet<u32>>,
    variables: Vec<Variable>,
}

struct Variable {
    id: u32,
    pointer: u32,
    storage: u32,
}

impl Reflection {
    /// Reads a module. The error completes "not a usable SPIR-V module:".
    pub(crate) fn read(words: &[u32]) -> Result<Self, String> {
        if words.first() != Some(&MAGIC) {
            return Err("it does not begin with SPIR-V's magic number".to_owned());
        }
        let mut entry = None;
        let mut group_size = None;
        let mut found = Declarations::default();
        let mut size_by_constant = HashSet::new();
        let mut votes = false;
        let mut rest = words.get(HEADER_WORDS..).unwrap_or(&[]);
        while let Some(&first) = rest.first() {
            let length = (first >> 16) as usize;
            let Some(operands) = rest.get(1..length) else {
                let at = words.len() - rest.len();
                return Err(format!("the instruction at word {at} is cut short"));
            };
            rest = &rest[length..];
            // Only the low half is the opcode.
            match (first as u16, operands) {
                (op::ENTRY_POINT, [MODEL_GL_COMPUTE, _, name @ ..]) => {
                    if entry.replace(string(name)?).is_some() {
                        return Err("it has more than one compute entry point".to_owned());
                    }
                }
                (op::CAPABILITY, [CAPABILITY_BALLOT | CAPABILITY_SUBGROUP_BALLOT_KHR]) => {
                    votes = true
                }
                (op::EXECUTION_MODE, &[_, MODE_LOCAL_SIZE, x, y, z]) => {
                    group_size = Some([x, y, z]);
                }
                (op::DECORATE, &[id, decoration::BUILT_IN, BUILT_IN_WORKGROUP_SIZE]) => {
                    size_by_constant.insert(id);
                }
                (op::SPEC_CONSTANT_COMPOSITE, &[_, id, ..]) if size_by_constant.contains(&id) => {
                    return Err("its workgroup size is a specialization constant".to_owned());
                }
                (opcode, operands) => found.note(opcode, operands),
            }
        }
        let entry = entry.ok_or("it has no compute entry point")?;
        let group_size = group_size.ok_or("it has no literal workgroup size")?;
        if group_size.contains(&0) {
            return Err("its workgroup size is zero along an axis".to_owned());
        }
        let resources = found.resources();
        let push_bytes = found
            .push_bytes()
            .ok_or("its push constants have a member of another size than 4 bytes")?;
        let is_specialized = found.is_specialized;
        Ok(Self { entry, group_size, resources, push_bytes, is_specialized, votes })
    }
}

impl Declarations {
    fn note(&mut self, opcode: u16, operands: &[u32]) {
        match (opcode, operands) {
            (op::TYPE_FLOAT, &[id, 32, ..]) => {
                self.sizes.insert(id, 4);
                self.scalars.insert(id, TexelType::Float);
            }
            (op::TYPE_INT, &[id, 32, signed]) => {
                let texel = if signed == 0 { TexelType::Uint } else { TexelType::Int };
                self.sizes.insert(id, 4);
                self.scalars.insert(id, texel);
            }
            (op::TYPE_VECTOR, &[id, scalar, count]) => {
                if let Some(size) = self.sizes.get(&scalar).copied() {
                    self.sizes.insert(id, size * count as usize);
                }
            }
            (op::TYPE_ARRAY, &[id, element, count]) => {
                self.arrays.insert(id, [element, count]);
            }
            (op::CONSTANT, &[_, id, value]) => {
                self.constants.insert(id, value);
            }
            (op::TYPE_IMAGE, &[id, scalar, dim, _, arrayed, multisampled, sampled, ..]) => {
                let kind = match (self.scalars.get(&scalar), dim, sampled) {
                    (Some(&texel), DIM_2D, IMAGE_STORAGE) if arrayed + multisampled == 0 => {
                        ResourceKind::StorageImage(texel)
                    }
                    (Some(&texel), DIM_BUFFER, IMAGE_SAMPLED) => {
                        ResourceKind::UniformTexelBuffer(texel)
                    }
                    _ => ResourceKind::Other,
                };
                self.images.insert(id, kind);
            }
            (op::TYPE_SAMPLED_IMAGE, &[id, image]) => {
                // glslang wraps a samplerBuffer so; other images with samplers are not for us.
                let kind = match self.images.get(&image) {
                    Some(&texel_buffer @ ResourceKind::UniformTexelBuffer(_)) => texel_buffer,
                    _ => ResourceKind::Other,
                };
                self.images.insert(id, kind);
            }
            (op::TYPE_STRUCT, &[id, ref members @ ..]) => {
                self.struct_members.insert(id, members.to_vec());
            }
            (op::TYPE_POINTER, &[id, _, pointee]) => {
                self.pointees.insert(id, pointee);
            }
            (op::VARIABLE, &[pointer, id, storage, ..]) => {
                self.variables.push(Variable { id, pointer, storage });
            }
            (op::DECORATE, &[id, decoration::BINDING, binding]) => {
                self.bindings.insert(id, binding);
            }
            (op::DECORATE, &[id, decoration::DESCRIPTOR_SET, set]) => {
                self.sets.insert(id, set);
            }
            (op::DECORATE, &[id, decoration::ARRAY_STRIDE, stride]) => {
                self.strides.insert(id, stride);
            }
            (op::DECORATE, &[_, decoration::SPEC_ID, 0 | 1]) => self.is_specialized = true,
            (op::MEMBER_DECORATE, &[id, member, decoration::OFFSET, offset]) => {
                self.offsets.insert((id, member), offset);
            }
            (op::DECORATE, &[id, decoration::NON_WRITABLE]) => {
                self.non_writable.insert(id);
            }
            (op::DECORATE, &[id, decoration::BUFFER_BLOCK]) => {
                self.buffer_blocks.insert(id);
            }
            (op::MEMBER_DECORATE, &[id, member, decoration::NON_WRITABLE]) => {
                self.non_writable_members.entry(id).or_default().insert(member);
            }
            _ => {}
        }
    }

    /// Bytes of the push constants; `None` where it is not known.
    fn push_bytes(&self) -> Option<usize> {
        let block = self.variables.iter().find(|of| of.storage == STORAGE_PUSH_CONSTANT);
        match block.and_then(|of| self.pointees.get(&of.pointer)) {
            Some(&block) => self.size(block),
            None => Some(0),
        }
    }

    /// Of a type, in bytes, without what follows a struct's last member; `None` where it is none of numbers of 4 bytes.
    fn size(&self, id: u32) -> Option<usize> {
        if let Some(members) = self.struct_members.get(&id) {
            let ends = members.iter().enumerate().map(|(at, &member)| {
                let offset = *self.offsets.get(&(id, at as u32))? as usize;
                Some(offset + self.size(member)?)
            });
            return ends
                .collect::<Option<Vec<_>>>()
                .map(|ends| ends.into_iter().max().unwrap_or(0));
        }
        if let Some([element, count]) = self.arrays.get(&id) {
            let stride = match self.strides.get(&id) {
                Some(&stride) => stride as usize,
                None => self.size(*element)?,
            };
            return Some(stride * *self.constants.get(count)? as usize);
        }
        self.sizes.get(&id).copied()
    }

    fn resources(&self) -> Vec<Resource> {
        let with_binding = |variable: &Variable| {
            let &binding = self.bindings.get(&variable.id)?;
            let pointee = self.pointees.get(&variable.pointer).copied().unwrap_or(0);
            let kind = self.kind(variable.storage, pointee);
            let is_read_only = matches!(kind, ResourceKind::UniformTexelBuffer(_))
                || self.non_writable.contains(&variable.id)
                || self.all_members_non_writable(pointee);
            Some(Resource {
                set: self.sets.get(&variable.id).copied().unwrap_or(0),
                binding,
                kind,
                access: if is_read_only { Access::Read } else { Access::Write },
            })
        };
        self.variables.iter().filter_map(with_binding).collect()
    }

    fn kind(&self, storage: u32, pointee: u32) -> ResourceKind {
        let is_struct = self.struct_members.contains_key(&pointee);
        match storage {
            STORAGE_STORAGE_BUFFER if is_struct => ResourceKind::StorageBuffer,
            // How SPIR-V before 1.3 wrote a storage buffer.
            STORAGE_UNIFORM if self.buffer_blocks.contains(&pointee) => ResourceKind::StorageBuffer,
            STORAGE_UNIFORM_CONSTANT => {
                self.images.get(&pointee).copied().unwrap_or(ResourceKind::Other)
            }
            _ => ResourceKind::Other,
        }
    }

    /// glslang writes a `readonly` buffer as one whose members are all non-writable.
    fn all_members_non_writable(&self, id: u32) -> bool {
        match (self.struct_members.get(&id), self.non_writable_members.get(&id)) {
            (Some(all), Some(members)) => {
                (0..all.len() as u32).all(|member| members.contains(&member))
            }
            _ => false,
        }
    }
}

/// A string literal: bytes in words, little end first, ended by a zero byte.
fn string(words: &[u32]) -> Result<CString, String> {
    let bytes = words.iter().flat_map(|word| word.to_le_bytes());
    let name: Vec<u8> = bytes.take_while(|&byte| byte != 0).collect();
    CString::new(name).map_err(|_| "its entry point has no proper name".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn instruction(opcode: u16, operands: &[u32]) -> Vec<u32> {
        let first = (operands.len() as u32 + 1) << 16 | u32::from(opcode);
        [&[first], operands].concat()
    }

    fn module(instructions: &[Vec<u32>]) -> Vec<u32> {
        [&[MAGIC, 0x0001_0300, 0, 100, 0], &instructions.concat()[..]].concat()
    }

    /// "main" and its terminating zero.
    const MAIN: [u32; 2] = [0x6e69_616d, 0];

    fn entry() -> Vec<Vec<u32>> {
        vec![
            instruction(op::ENTRY_POINT, &[MODEL_GL_COMPUTE, 1, MAIN[0], MAIN[1]]),
            instruction(op::EXECUTION_MODE, &[1, MODE_LOCAL_SIZE, 8, 4, 1]),
        ]
    }

    #[test]
    fn entry_point_and_group_size_are_read() {
        let read = Reflection::read(&module(&entry())).unwrap();
        assert_eq!(read.entry.as_c_str(), c"main");
        assert_eq!(read.group_size, [8, 4, 1]);
        assert_eq!(read.resources, []);
    }

    #[test]
    fn a_buffer_is_read_only_when_every_member_is() {
        let mut instructions = entry();
        instructions.extend([
            instruction(op::DECORATE, &[10, decoration::BINDING, 3]),
            instruction(op::DECORATE, &[10, decoration::DESCRIPTOR_SET, 0]),
            instruction(op::MEMBER_DECORATE, &[20, 0, decoration::NON_WRITABLE]),
            instruction(op::TYPE_INT, &[30, 32, 0]),
            instruction(op::TYPE_STRUCT, &[20, 30, 30]),
            instruction(op::TYPE_POINTER, &[21, STORAGE_STORAGE_BUFFER, 20]),
            instruction(op::VARIABLE, &[21, 10, STORAGE_STORAGE_BUFFER]),
        ]);
        let half = Reflection::read(&module(&instructions)).unwrap().resources;
        let kind = ResourceKind::StorageBuffer;
        assert_eq!(half, [Resource { set: 0, binding: 3, kind, access: Access::Write }]);
        instructions
            .insert(2, instruction(op::MEMBER_DECORATE, &[20, 1, decoration::NON_WRITABLE]));
        let whole = Reflection::read(&module(&instructions)).unwrap().resources;
        assert_eq!(whole, [Resource { set: 0, binding: 3, kind, access: Access::Read }]);
    }

    #[test]
    fn a_sampler_buffer_is_a_texel_buffer_of_its_scalar() {
        let mut instructions = entry();
        instructions.extend([
            instruction(op::DECORATE, &[10, decoration::BINDING, 7]),
            instruction(op::TYPE_INT, &[30, 32, 0]),
            instruction(op::TYPE_IMAGE, &[31, 30, DIM_BUFFER, 0, 0, 0, IMAGE_SAMPLED, 0]),
            instruction(op::TYPE_SAMPLED_IMAGE, &[32, 31]),
            instruction(op::TYPE_POINTER, &[33, STORAGE_UNIFORM_CONSTANT, 32]),
            instruction(op::VARIABLE, &[33, 10, STORAGE_UNIFORM_CONSTANT]),
        ]);
        let kind = ResourceKind::UniformTexelBuffer(TexelType::Uint);
        let resources = Reflection::read(&module(&instructions)).unwrap().resources;
        assert_eq!(resources, [Resource { set: 0, binding: 7, kind, access: Access::Read }]);
    }

    #[test]
    fn what_is_no_module_is_refused_with_a_reason() {
        let cases = [
            (vec![], "magic number"),
            (vec![1, 2, 3], "magic number"),
            (module(&[]), "no compute entry point"),
            (module(&entry()[..1]), "no literal workgroup size"),
            (module(&[entry(), entry()].concat()), "more than one"),
            (module(&[vec![9 << 16]]), "word 5 is cut short"),
            (module(&[vec![0]]), "word 5 is cut short"),
        ];
        for (words, reason) in cases {
            let error = Reflection::read(&words).unwrap_err();
            assert!(error.contains(reason), "{error}, expected {reason}");
        }
    }
}

//! Three small kernels, assembled here because a plain build has no GLSL compiler.

use rspirv::binary::Assemble;
use rspirv::dr::{Builder, Operand};
use rspirv::spirv::{
    AddressingModel, BuiltIn, Capability, Decoration, Dim, ExecutionMode, ExecutionModel,
    FunctionControl, ImageFormat, MemoryModel, SelectionControl, StorageClass, Word,
};

/// Input of every kernel here.
pub(crate) const INPUT: u32 = 0;
/// Output of every kernel here.
pub(crate) const OUTPUT: u32 = 1;

/// `if (i < output.length()) output[i] = input[i] + push`, 64 invocations a workgroup.
pub(crate) fn add() -> Vec<u32> {
    let mut m = Module::new([64, 1, 1]);
    let input = m.storage_buffer(INPUT, true);
    let output = m.storage_buffer(OUTPUT, false);
    let push = m.push_constant();
    m.main(|m, invocation| {
        let i = m.b.composite_extract(m.uint, None, invocation, [0]).unwrap();
        let length = m.b.array_length(m.uint, None, output, 0).unwrap();
        m.when_below(i, length, |m| {
            let pointer = m.pointer(StorageClass::StorageBuffer, m.uint);
            let zero = m.constant(0);
            let from = m.b.access_chain(pointer, None, input, [zero, i]).unwrap();
            let value = m.b.load(m.uint, None, from, None, []).unwrap();
            let pointer = m.pointer(StorageClass::PushConstant, m.uint);
            let addend = m.b.access_chain(pointer, None, push, [zero]).unwrap();
            let addend = m.b.load(m.uint, None, addend, None, []).unwrap();
            let sum = m.b.i_add(m.uint, None, value, addend).unwrap();
            m.store(output, i, sum);
        });
    });
    m.finish()
}

/// `output[i] = texelFetch(input, i).y`, 64 invocations a workgroup.
pub(crate) fn fetch() -> Vec<u32> {
    let mut m = Module::new([64, 1, 1]);
    m.b.capability(Capability::SampledBuffer);
    let image = m.b.type_image(m.uint, Dim::DimBuffer, 0, 0, 0, 1, ImageFormat::Unknown, None);
    let sampled = m.b.type_sampled_image(image);
    let input = m.variable(StorageClass::UniformConstant, sampled, INPUT);
    let output = m.storage_buffer(OUTPUT, false);
    m.main(|m, invocation| {
        let i = m.b.composite_extract(m.uint, None, invocation, [0]).unwrap();
        let length = m.b.array_length(m.uint, None, output, 0).unwrap();
        m.when_below(i, length, |m| {
            let texels = m.b.load(sampled, None, input, None, []).unwrap();
            let texels = m.b.image(image, None, texels).unwrap();
            let texel = m.b.image_fetch(m.uvec4, None, texels, i, None, []).unwrap();
            let y = m.b.composite_extract(m.uint, None, texel, [1]).unwrap();
            m.store(output, i, y);
        });
    });
    m.finish()
}

/// `imageStore(output, pixel, imageLoad(input, pixel) + uvec4(gl_GlobalInvocationID, 1))`, 8 by 4
/// invocations a workgroup. Beyond the edge loads give zero and stores do nothing.
pub(crate) fn step_image() -> Vec<u32> {
    let mut m = Module::new([8, 4, 1]);
    let image = m.b.type_image(m.uint, Dim::Dim2D, 0, 0, 0, 2, ImageFormat::Rgba32ui, None);
    let input = m.variable(StorageClass::UniformConstant, image, INPUT);
    m.b.decorate(input, Decoration::NonWritable, []);
    let output = m.variable(StorageClass::UniformConstant, image, OUTPUT);
    m.b.decorate(output, Decoration::NonReadable, []);
    m.main(|m, invocation| {
        let uvec2 = m.b.type_vector(m.uint, 2);
        let pixel = m.b.vector_shuffle(uvec2, None, invocation, invocation, [0, 1]).unwrap();
        let one = m.constant(1);
        let step = m.b.composite_construct(m.uvec4, None, [invocation, one]).unwrap();
        let from = m.b.load(image, None, input, None, []).unwrap();
        let texel = m.b.image_read(m.uvec4, None, from, pixel, None, []).unwrap();
        let texel = m.b.i_add(m.uvec4, None, texel, step).unwrap();
        let to = m.b.load(image, None, output, None, []).unwrap();
        m.b.image_write(to, pixel, texel, None, []).unwrap();
    });
    m.finish()
}

/// A compute module under construction.
struct Module {
    b: Builder,
    group_size: [u32; 3],
    uint: Word,
    uvec4: Word,
}

impl Module {
    fn new(group_size: [u32; 3]) -> Self {
        let mut b = Builder::new();
        b.set_version(1, 3);
        b.capability(Capability::Shader);
        b.memory_model(AddressingModel::Logical, MemoryModel::GLSL450);
        let uint = b.type_int(32, 0);
        let uvec4 = b.type_vector(uint, 4);
        Self { b, group_size, uint, uvec4 }
    }

    fn constant(&mut self, value: u32) -> Word {
        self.b.constant_bit32(self.uint, value)
    }

    fn pointer(&mut self, storage: StorageClass, to: Word) -> Word {
        self.b.type_pointer(None, storage, to)
    }

    fn variable(&mut self, storage: StorageClass, of: Word, binding: u32) -> Word {
        let pointer = self.pointer(storage, of);
        let variable = self.b.variable(pointer, None, storage, None);
        self.b.decorate(variable, Decoration::DescriptorSet, [Operand::LiteralBit32(0)]);
        self.b.decorate(variable, Decoration::Binding, [Operand::LiteralBit32(binding)]);
        variable
    }

    /// `buffer { uint values[]; }`. Types of its own: decorations must not be shared.
    fn storage_buffer(&mut self, binding: u32, readonly: bool) -> Word {
        let array = self.b.id();
        self.b.type_runtime_array_id(Some(array), self.uint);
        self.b.decorate(array, Decoration::ArrayStride, [Operand::LiteralBit32(4)]);
        let block = self.block(array);
        if readonly {
            self.b.member_decorate(block, 0, Decoration::NonWritable, []);
        }
        self.variable(StorageClass::StorageBuffer, block, binding)
    }

    /// `push_constant { uint value; }`
    fn push_constant(&mut self) -> Word {
        let block = self.block(self.uint);
        let pointer = self.pointer(StorageClass::PushConstant, block);
        self.b.variable(pointer, None, StorageClass::PushConstant, None)
    }

    fn block(&mut self, member: Word) -> Word {
        let block = self.b.id();
        self.b.type_struct_id(Some(block), [member]);
        self.b.decorate(block, Decoration::Block, []);
        self.b.member_decorate(block, 0, Decoration::Offset, [Operand::LiteralBit32(0)]);
        block
    }

    fn store(&mut self, buffer: Word, index: Word, value: Word) {
        let pointer = self.pointer(StorageClass::StorageBuffer, self.uint);
        let zero = self.constant(0);
        let to = self.b.access_chain(pointer, None, buffer, [zero, index]).unwrap();
        self.b.store(to, value, None, []).unwrap();
    }

    fn when_below(&mut self, value: Word, limit: Word, then: impl FnOnce(&mut Self)) {
        let boolean = self.b.type_bool();
        let below = self.b.u_less_than(boolean, None, value, limit).unwrap();
        let (inside, after) = (self.b.id(), self.b.id());
        self.b.selection_merge(after, SelectionControl::NONE).unwrap();
        self.b.branch_conditional(below, inside, after, []).unwrap();
        self.b.begin_block(Some(inside)).unwrap();
        then(self);
        self.b.branch(after).unwrap();
        self.b.begin_block(Some(after)).unwrap();
    }

    /// The entry point, whose body gets `gl_GlobalInvocationID`.
    fn main(&mut self, body: impl FnOnce(&mut Self, Word)) {
        let uvec3 = self.b.type_vector(self.uint, 3);
        let pointer = self.pointer(StorageClass::Input, uvec3);
        let invocation = self.b.variable(pointer, None, StorageClass::Input, None);
        let built_in = Operand::BuiltIn(BuiltIn::GlobalInvocationId);
        self.b.decorate(invocation, Decoration::BuiltIn, [built_in]);

        let void = self.b.type_void();
        let function = self.b.type_function(void, []);
        let main = self.b.begin_function(void, None, FunctionControl::NONE, function).unwrap();
        self.b.begin_block(None).unwrap();
        let invocation_value = self.b.load(uvec3, None, invocation, None, []).unwrap();
        body(self, invocation_value);
        self.b.ret().unwrap();
        self.b.end_function().unwrap();
        self.b.entry_point(ExecutionModel::GLCompute, main, "main", [invocation]);
        self.b.execution_mode(main, ExecutionMode::LocalSize, self.group_size);
    }

    fn finish(self) -> Vec<u32> {
        self.b.module().assemble()
    }
}

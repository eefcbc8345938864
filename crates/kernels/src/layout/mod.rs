//! What host and kernels share, stated once: constants, structs, and the numbers of bindings, stage by stage.
//!
//! A stage is a part of the work: points, search, grid, tree, discs, rays, wave, volume, film. Its file here yields the Rust
//! side by [`stage!`]; `compile-kernels` writes the GLSL side of it to `glsl/stages/`: the same constants and
//! structs, and for each binding that has a reader, functions that read one of its elements, or one member of one, from a
//! storage buffer or, with TEXELS, from a uniform texel buffer.
//!
//! The test `stages_are_up_to_date` compares the files; `layout_matches_spirv` the offsets with those in the modules.

mod discs;
mod film;
mod grid;
mod points;
mod rays;
mod scene;
mod search;
mod tree;
mod volume;
mod wave;

pub use discs::*;
pub use film::*;
pub use grid::*;
pub use points::*;
pub use rays::*;
pub use scene::*;
pub use search::*;
pub use tree::*;
pub use volume::*;
pub use wave::*;

/// All stages.
#[allow(unused_qualifications, reason = "each stage has a constant of this name")]
pub const STAGES: &[Stage] = &[
    points::STAGE,
    scene::STAGE,
    search::STAGE,
    grid::STAGE,
    tree::STAGE,
    discs::STAGE,
    rays::STAGE,
    wave::STAGE,
    volume::STAGE,
    film::STAGE,
];

/// One stage, as the host knows it.
#[derive(Debug, Clone, Copy)]
pub struct Stage {
    /// The stem of its files.
    pub name: &'static str,
    /// What its GLSL side says of it.
    pub about: &'static [&'static str],
    /// Stages whose structs are members of its own, or elements of its bindings.
    pub needs: &'static [&'static str],
    /// Its constants.
    pub constants: &'static [Constant],
    /// Its bindings.
    pub bindings: &'static [Binding],
    /// Its structs.
    pub structs: &'static [StructLayout],
}

/// A number that host and kernels share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Constant {
    /// In Rust and in GLSL.
    pub name: &'static str,
    /// Of 32 bits.
    pub value: u32,
    /// What it means, by lines.
    pub doc: &'static [&'static str],
}

/// A number by which kernels name a buffer or an image. No two bindings have the same one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Binding {
    /// In Rust and in GLSL.
    pub name: &'static str,
    /// In set 0.
    pub number: u32,
    /// What the buffer is a list of, or `None`: an image.
    pub element: Option<Type>,
    /// How many values of 4 bytes a texel has, where it is read as texels.
    pub texel: u32,
    /// What functions that read an element are named after.
    pub reader: Option<&'static str>,
    /// What it is, by lines.
    pub doc: &'static [&'static str],
}

/// A struct's GLSL name, its size, and its members, as Rust lays them out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StructLayout {
    /// Name in GLSL and in Rust.
    pub name: &'static str,
    /// Size in bytes.
    pub size: usize,
    /// In order.
    pub members: &'static [Member],
    /// What it is, by lines.
    pub doc: &'static [&'static str],
}

/// A member of a struct.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Member {
    /// Name in GLSL and in Rust.
    pub name: &'static str,
    /// In bytes.
    pub offset: usize,
    /// Of the member.
    pub kind: Type,
    /// What it is, by lines.
    pub doc: &'static [&'static str],
}

/// A type that both sides know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    /// So many numbers of 4 bytes: one is a scalar, two to four a vector where std430 lets them lie so, else an array.
    Numbers(Number, usize),
    /// One of these structs.
    Struct(&'static StructLayout),
}

/// A number of 4 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    /// `f32`, `float`.
    Float,
    /// `u32`, `uint`.
    Uint,
    /// `i32`, `int`.
    Int,
}

/// A Rust type that kernels know.
pub trait Shared: bytemuck::Pod {
    /// As which type.
    const TYPE: Type;
}

impl Shared for f32 {
    const TYPE: Type = Type::Numbers(Number::Float, 1);
}

impl Shared for u32 {
    const TYPE: Type = Type::Numbers(Number::Uint, 1);
}

impl Shared for i32 {
    const TYPE: Type = Type::Numbers(Number::Int, 1);
}

impl<const COUNT: usize> Shared for [f32; COUNT]
where
    Self: bytemuck::Pod,
{
    const TYPE: Type = Type::Numbers(Number::Float, COUNT);
}

impl<const COUNT: usize> Shared for [u32; COUNT]
where
    Self: bytemuck::Pod,
{
    const TYPE: Type = Type::Numbers(Number::Uint, COUNT);
}

impl Type {
    /// In bytes, as Rust has it.
    #[must_use]
    pub const fn size(self) -> usize {
        match self {
            Self::Numbers(_, count) => 4 * count,
            Self::Struct(layout) => layout.size,
        }
    }

    /// Values of 4 bytes that a texel has by which it is read.
    #[must_use]
    pub const fn texel(self) -> u32 {
        match self.size() {
            4 => 1,
            8 => 2,
            _ => 4,
        }
    }
}

/// Every struct that host and kernels share.
pub fn structs() -> impl Iterator<Item = &'static StructLayout> {
    STAGES.iter().flat_map(|stage| stage.structs)
}

/// Every binding.
pub fn bindings() -> impl Iterator<Item = &'static Binding> {
    STAGES.iter().flat_map(|stage| stage.bindings)
}

/// Of a number.
#[must_use]
pub fn binding(number: u32) -> Option<&'static Binding> {
    bindings().find(|binding| binding.number == number)
}

/// States a stage: `needs` others, `constants`, `bindings` whose numbers follow those of the stage before (with a struct or number as the element,
/// `by 4` where single numbers are read four at a time, `as` what the functions that read it are named after, `image` where it
/// is none of a buffer), `structs`.
macro_rules! stage {
    (
        $(#![doc = $about:literal])*
        $stage:literal needs [$($needs:literal),*]
        constants { $($(#[doc = $cdoc:literal])* $constant:ident = $value:expr;)* }
        bindings after [$($previous:ident)?] {
            $($(#[doc = $bdoc:literal])* $binding:ident: $element:tt $(by $texel:literal)? $(as $reader:ident)?;)*
        }
        structs {
            $($(#[doc = $sdoc:literal])* $name:ident {
                $($(#[doc = $fdoc:literal])* $field:ident: $kind:ty,)*
            })*
        }
    ) => {
        $($(#[doc = $cdoc])* pub const $constant: u32 = $value;)*

        #[allow(non_camel_case_types, clippy::upper_case_acronyms, reason = "names of constants, to count them")]
        #[allow(dead_code, reason = "a stage may have no binding")]
        enum Place { $($binding,)* End }
        #[allow(dead_code, reason = "a stage may have no binding")]
        const FIRST: u32 = crate::layout::first(&[$(super::$previous::END,)? 0]);
        #[allow(dead_code, reason = "after the last stage there is none")]
        /// One more than the last of its bindings, which the next stage begins with.
        pub(super) const END: u32 = FIRST + Place::End as u32;
        $($(#[doc = $bdoc])* pub const $binding: u32 = FIRST + Place::$binding as u32;)*

        $(
            $(#[doc = $sdoc])*
            #[derive(Debug, Clone, Copy, PartialEq, Default, bytemuck::Pod, bytemuck::Zeroable)]
            #[repr(C)]
            pub struct $name { $($(#[doc = $fdoc])* pub $field: $kind,)* }

            impl crate::layout::Shared for $name {
                const TYPE: crate::layout::Type = crate::layout::Type::Struct(&crate::layout::StructLayout {
                    name: stringify!($name),
                    size: size_of::<$name>(),
                    members: &[$(crate::layout::Member {
                        name: stringify!($field),
                        offset: std::mem::offset_of!($name, $field),
                        kind: <$kind as crate::layout::Shared>::TYPE,
                        doc: &[$($fdoc),*],
                    },)*],
                    doc: &[$($sdoc),*],
                });
            }
        )*

        /// This stage.
        pub(super) const STAGE: crate::layout::Stage = crate::layout::Stage {
            name: $stage,
            about: &[$($about),*],
            needs: &[$($needs),*],
            constants: &[$(crate::layout::Constant {
                name: stringify!($constant), value: $constant, doc: &[$($cdoc),*],
            },)*],
            bindings: &[$(stage!(@binding $binding, [$($bdoc),*], $element, [$($texel)?], [$($reader)?]),)*],
            structs: &[$(match <$name as crate::layout::Shared>::TYPE {
                crate::layout::Type::Struct(layout) => *layout,
                crate::layout::Type::Numbers(..) => panic!("a struct"),
            },)*],
        };
    };
    (@binding $name:ident, [$($doc:literal),*], image, [], []) => {
        crate::layout::Binding {
            name: stringify!($name), number: $name, element: None, texel: 0, reader: None, doc: &[$($doc),*],
        }
    };
    (@binding $name:ident, [$($doc:literal),*], $element:tt, [$($texel:literal)?], [$($reader:ident)?]) => {
        crate::layout::Binding {
            name: stringify!($name),
            number: $name,
            element: Some(<$element as crate::layout::Shared>::TYPE),
            texel: crate::layout::first(&[$($texel,)? <$element as crate::layout::Shared>::TYPE.texel()]),
            reader: crate::layout::first(&[$(Some(stringify!($reader)),)? None]),
            doc: &[$($doc),*],
        }
    };
}
use stage;

/// What was given, else what follows from the element.
const fn first<T: Copy>(of: &[T]) -> T {
    of[0]
}

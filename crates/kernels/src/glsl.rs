//! The GLSL side of the stages in [`layout`](crate::layout): `glsl/stages/*.glsl`.

use crate::layout::{Binding, Member, Number, Stage, StructLayout, Type, bindings};
use std::fmt::Write as _;

/// The text of a stage's file.
#[must_use]
pub fn stage_text(stage: &Stage) -> String {
    let mut text = format!("// {}: {}\n", stage.name, first_lower(&sentence(stage.about)));
    text += &format!(
        "//\n// Made from crates/kernels/src/layout/{}.rs by compile-kernels: change that.\n",
        stage.name
    );
    let guard = format!("STAGE_{}_GLSL", stage.name.to_uppercase());
    text += &format!("#ifndef {guard}\n#define {guard}\n");
    for needed in stage.needs {
        text += &format!("#include \"stages/{needed}.glsl\"\n");
    }
    if !stage.constants.is_empty() {
        text += "\n";
    }
    for constant in stage.constants {
        let value = match constant.value {
            large @ 0x1000_0000.. => format!("{large:#x}u"),
            value => value.to_string(),
        };
        text += &format!("#define {} {value}{}\n", constant.name, comment(constant.doc));
    }
    for layout in stage.structs {
        text += &struct_text(layout);
    }
    for binding in stage.bindings {
        text += &binding_text(binding);
    }
    text + "#endif\n"
}

/// A struct, and how it is read from texels.
fn struct_text(layout: &StructLayout) -> String {
    let mut text = format!(
        "\n// {}\nstruct {} {{ // {} bytes\n",
        sentence(layout.doc),
        layout.name,
        layout.size
    );
    for member in layout.members {
        let declared = format!("{};", declaration(layout, member));
        let about = sentence(member.doc);
        let _ = writeln!(text, "    {declared:<32} // {:3} {about}", member.offset);
    }
    text += "};\n";
    if is_read(layout) {
        let count = layout.size.div_ceil(16);
        let fetch = |i: usize| format!("    uvec4 t{i} = texelFetch(texels, first + {i});\n");
        text += &format!(
            "\n#ifdef TEXELS\n{0} {1}_from(usamplerBuffer texels, int first) {{\n{2}    return {3};\n}}\n#endif\n",
            layout.name,
            snake(layout.name),
            (0..count).map(fetch).collect::<String>(),
            constructed(layout, 0)
        );
    }
    text
}

/// A binding's number, and functions that read what is bound there.
fn binding_text(binding: &Binding) -> String {
    let mut text =
        format!("\n#define {} {}{}\n", binding.name, binding.number, comment(binding.doc));
    let (Some(reader), Some(element)) = (binding.reader, binding.element) else { return text };
    let (name, at) = (binding.name, format!("{reader}_at"));
    let kind = type_name(element);
    text += &format!(
        "#ifdef TEXELS\nlayout(binding = {name}) uniform usamplerBuffer {reader}_texels;\n\n"
    );
    match element {
        Type::Struct(layout) => {
            let texels = layout.size.div_ceil(16);
            let first =
                if texels == 1 { "int(at)".to_owned() } else { format!("int({texels}u * at)") };
            text += &format!(
                "{kind} {at}(uint at) {{\n    return {}_from({reader}_texels, {first});\n}}\n",
                snake(layout.name)
            );
            for member in layout.members {
                text += &member_from_texels(reader, &first, layout, member);
            }
        }
        Type::Numbers(number, 1) if binding.texel == 4 => {
            let four = vector(number, 4);
            text += &format!(
                "{kind} {at}(uint at) {{\n    return {0}[at & 3u];\n}}\n\n\
                 // The four of which that is one, from a multiple of four on.\n{four} {reader}_four_at(uint at) {{\n    return {0};\n}}\n",
                cast(number, 4, &format!("texelFetch({reader}_texels, int(at / 4u))"))
            );
        }
        Type::Numbers(number, count) => {
            let part = ["x", "xy", "xyz", "xyzw"][count - 1];
            let value =
                cast(number, count, &format!("texelFetch({reader}_texels, int(at)).{part}"));
            text += &format!("{kind} {at}(uint at) {{\n    return {value};\n}}\n");
        }
    }
    let plain = format!("{reader}_list");
    text += &format!(
        "#else\nlayout(std430, binding = {name}) readonly buffer {} {{ {kind} {plain}[]; }};\n\n\
         {kind} {at}(uint at) {{\n    return {plain}[at];\n}}\n",
        camel(&plain)
    );
    match element {
        Type::Struct(layout) => {
            for member in layout.members {
                text += &member_from_list(reader, &plain, layout, member);
            }
        }
        Type::Numbers(number, 1) if binding.texel == 4 => {
            text += &format!(
                "\n{0} {reader}_four_at(uint at) {{\n    uint first = at & ~3u;\n    return {0}({plain}[first], \
                 {plain}[first + 1u], {plain}[first + 2u], {plain}[first + 3u]);\n}}\n",
                vector(number, 4)
            );
        }
        Type::Numbers(..) => {}
    }
    text + "#endif\n"
}

/// One member of an element, from the texels that have it.
fn member_from_texels(reader: &str, first: &str, layout: &StructLayout, member: &Member) -> String {
    let fetch = |texel: usize| match texel {
        0 => format!("texelFetch({reader}_texels, {first})"),
        _ => format!("texelFetch({reader}_texels, {first} + {texel})"),
    };
    let name = member.name;
    let Type::Numbers(number, count) = member.kind else { return String::new() };
    if is_array(layout, member) {
        let word = match member.offset / 4 {
            0 => "i".to_owned(),
            words => format!("({words}u + i)"),
        };
        let texel = format!("texelFetch({reader}_texels, {first} + int({word} / 4u))[{word} & 3u]");
        return format!(
            "\n{} {reader}_{name}_at(uint at, uint i) {{\n    return {};\n}}\n",
            vector(number, 1),
            cast(number, 1, &texel)
        );
    }
    let part = swizzle(member.offset, count);
    format!(
        "\n{} {reader}_{name}_at(uint at) {{\n    return {};\n}}\n",
        vector(number, count),
        cast(number, count, &format!("{}{part}", fetch(member.offset / 16)))
    )
}

/// One member of an element, from a storage buffer.
fn member_from_list(reader: &str, list: &str, layout: &StructLayout, member: &Member) -> String {
    let name = member.name;
    let Type::Numbers(number, count) = member.kind else { return String::new() };
    match is_array(layout, member) {
        true => format!(
            "\n{} {reader}_{name}_at(uint at, uint i) {{\n    return {list}[at].{name}[i];\n}}\n",
            vector(number, 1)
        ),
        false => format!(
            "\n{} {reader}_{name}_at(uint at) {{\n    return {list}[at].{name};\n}}\n",
            vector(number, count)
        ),
    }
}

/// A struct from its texels, the first of which has the byte `base`.
fn constructed(layout: &StructLayout, base: usize) -> String {
    let of = |member: &Member| {
        let offset = base + member.offset;
        match member.kind {
            Type::Struct(inner) => constructed(inner, offset),
            Type::Numbers(number, count) if is_array(layout, member) => {
                let one = |i: usize| {
                    cast(
                        number,
                        1,
                        &format!("t{}{}", (offset + 4 * i) / 16, swizzle(offset + 4 * i, 1)),
                    )
                };
                let all: Vec<String> = (0..count).map(one).collect();
                format!("{}[]({})", vector(number, 1), all.join(", "))
            }
            Type::Numbers(number, count) => {
                cast(number, count, &format!("t{}{}", offset / 16, swizzle(offset, count)))
            }
        }
    };
    let members: Vec<String> = layout.members.iter().map(of).collect();
    format!("{}({})", layout.name, members.join(", "))
}

/// Whether std430 lets a member's numbers lie there as an array only: no vector may begin there, or it would leave a
/// gap between the elements of a list.
fn is_array(layout: &StructLayout, member: &Member) -> bool {
    let Type::Numbers(_, count) = member.kind else { return false };
    let fits = |bytes: usize| {
        let stride = if is_listed(layout) { layout.size } else { bytes };
        member.offset.is_multiple_of(bytes) && stride.is_multiple_of(bytes)
    };
    !alignment(count).is_some_and(fits)
}

/// Whether buffers are lists of a struct.
fn is_listed(layout: &StructLayout) -> bool {
    bindings().any(|binding| matches!(binding.element, Some(Type::Struct(element)) if element.name == layout.name))
}

/// Whether functions read elements of such a list.
fn is_read(layout: &StructLayout) -> bool {
    let reads = |binding: &Binding| matches!(binding.element, Some(Type::Struct(element)) if element.name == layout.name);
    bindings().any(|binding| binding.reader.is_some() && reads(binding))
}

/// Of a vector, or `None`: there is none of so many.
fn alignment(count: usize) -> Option<usize> {
    match count {
        1 => Some(4),
        2 => Some(8),
        3 | 4 => Some(16),
        _ => None,
    }
}

/// Where std430 puts a member that follows `end` bytes of others, and the bytes that its struct is aligned to for it.
#[must_use]
pub fn std430_place(layout: &StructLayout, member: &Member, end: usize) -> (usize, usize) {
    let aligned = match member.kind {
        Type::Struct(inner) => struct_alignment(inner),
        Type::Numbers(..) if is_array(layout, member) => 4,
        Type::Numbers(_, count) => alignment(count).unwrap_or(4),
    };
    (end.next_multiple_of(aligned), aligned)
}

/// The largest alignment among a struct's members.
#[must_use]
pub fn struct_alignment(layout: &StructLayout) -> usize {
    layout.members.iter().map(|member| std430_place(layout, member, 0).1).max().unwrap_or(4)
}

fn declaration(layout: &StructLayout, member: &Member) -> String {
    match member.kind {
        Type::Numbers(number, count) if is_array(layout, member) => {
            format!("{} {}[{count}]", vector(number, 1), member.name)
        }
        kind => format!("{} {}", type_name(kind), member.name),
    }
}

fn type_name(kind: Type) -> String {
    match kind {
        Type::Numbers(number, count) => vector(number, count),
        Type::Struct(layout) => layout.name.to_owned(),
    }
}

fn vector(number: Number, count: usize) -> String {
    let (scalar, letter) = match number {
        Number::Float => ("float", ""),
        Number::Uint => ("uint", "u"),
        Number::Int => ("int", "i"),
    };
    if count == 1 { scalar.to_owned() } else { format!("{letter}vec{count}") }
}

/// Bits of texels, which are unsigned integers, as numbers.
fn cast(number: Number, count: usize, bits: &str) -> String {
    match (number, count) {
        (Number::Float, _) => format!("uintBitsToFloat({bits})"),
        (Number::Uint, _) => bits.to_owned(),
        (Number::Int, 1) => format!("int({bits})"),
        (Number::Int, _) => format!("ivec{count}({bits})"),
    }
}

fn swizzle(offset: usize, count: usize) -> String {
    let first = offset % 16 / 4;
    if count == 4 { String::new() } else { format!(".{}", &"xyzw"[first..first + count]) }
}

/// The lines of a doc comment as one, without links.
fn sentence(doc: &[&str]) -> String {
    let all: Vec<&str> = doc.iter().map(|line| line.trim()).collect();
    all.join(" ")
        .replace("[`", "")
        .replace("`]", "")
        .replace('`', "")
        .replace("::", ".")
        .replace("\\[", "[")
        .replace("\\]", "]")
}

fn comment(doc: &[&str]) -> String {
    let text = sentence(doc);
    if text.is_empty() { text } else { format!(" // {}", text.trim_end_matches('.')) }
}

fn first_lower(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_lowercase().chain(chars).collect())
}

/// `LitHit` as `lit_hit`.
fn snake(name: &str) -> String {
    let mut out = String::new();
    for (i, c) in name.char_indices() {
        if c.is_uppercase() && i > 0 {
            out.push('_');
        }
        out.extend(c.to_lowercase());
    }
    out
}

/// `lit_hit` as `LitHit`.
fn camel(name: &str) -> String {
    name.split('_').map(|word| word[..1].to_uppercase() + &word[1..]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::{STAGES, structs};
    use std::collections::BTreeSet;

    #[test]
    fn stages_are_up_to_date() {
        for stage in STAGES {
            let path = crate::source::glsl_folder().join(format!("stages/{}.glsl", stage.name));
            let committed = std::fs::read_to_string(&path).unwrap_or_default();
            assert!(
                committed == stage_text(stage),
                "{} is not what crates/kernels/src/layout says; mend it with\n    cargo run --release \
                 -p pointillist-kernels --features compile --bin compile-kernels",
                path.display()
            );
        }
    }

    /// A struct with each kind of member: vectors, a lone number, a struct inside, an array, one that begins within a texel.
    const EVERY_KIND: StructLayout = StructLayout {
        name: "Every",
        size: 80,
        members: &[
            member("place", 0, Type::Numbers(Number::Float, 3)),
            member("count", 12, Type::Numbers(Number::Int, 1)),
            member("inner", 16, Type::Struct(&INNER)),
            member("pair", 24, Type::Numbers(Number::Uint, 2)),
            member("list", 32, Type::Numbers(Number::Uint, 8)),
            member("value", 64, Type::Numbers(Number::Float, 1)),
            member("glow", 68, Type::Numbers(Number::Float, 3)),
        ],
        doc: &[],
    };
    const INNER: StructLayout = StructLayout {
        name: "Inner",
        size: 8,
        members: &[
            member("first", 0, Type::Numbers(Number::Float, 1)),
            member("second", 4, Type::Numbers(Number::Uint, 1)),
        ],
        doc: &[],
    };

    const fn member(name: &'static str, offset: usize, kind: Type) -> Member {
        Member { name, offset, kind, doc: &[] }
    }

    /// Word by word: byte 4 n of a struct is component n % 4 of its texel n / 4.
    #[test]
    fn texels_are_taken_apart_where_members_lie() {
        assert_eq!(
            constructed(&EVERY_KIND, 0),
            "Every(uintBitsToFloat(t0.xyz), int(t0.w), Inner(uintBitsToFloat(t1.x), t1.y), t1.zw, \
             uint[](t2.x, t2.y, t2.z, t2.w, t3.x, t3.y, t3.z, t3.w), uintBitsToFloat(t4.x), \
             float[](uintBitsToFloat(t4.y), uintBitsToFloat(t4.z), uintBitsToFloat(t4.w)))"
        );
        let one = |at: usize| {
            member_from_texels("every", "int(5u * at)", &EVERY_KIND, &EVERY_KIND.members[at])
        };
        assert!(one(0).contains("vec3 every_place_at(uint at) {"), "{}", one(0));
        assert!(one(0).contains("uintBitsToFloat(texelFetch(every_texels, int(5u * at)).xyz)"));
        assert!(one(1).contains("return int(texelFetch(every_texels, int(5u * at)).w);"));
        assert!(one(3).contains("texelFetch(every_texels, int(5u * at) + 1).zw;"));
        let of_list = "int(5u * at) + int((8u + i) / 4u))[(8u + i) & 3u]";
        assert!(one(4).contains(of_list), "{}", one(4));
        assert!(one(6).contains("int((17u + i) / 4u))[(17u + i) & 3u]"), "{}", one(6));
    }

    /// What std430 makes of the members' types is where Rust has put them, and elements of lists leave no gap.
    #[test]
    fn std430_agrees_with_rust() {
        for layout in structs() {
            let mut end = 0;
            for member in layout.members {
                let (offset, _) = std430_place(layout, member, end);
                assert_eq!(offset, member.offset, "{}.{}", layout.name, member.name);
                end = offset + member.kind.size();
            }
            assert_eq!(end, layout.size, "{}: size", layout.name);
        }
        for binding in bindings() {
            if let Some(Type::Struct(layout)) = binding.element {
                let stride = layout.size.next_multiple_of(struct_alignment(layout));
                assert_eq!(
                    stride, layout.size,
                    "{}: what {} is a list of",
                    layout.name, binding.name
                );
            }
        }
    }

    /// Elements that are read as texels fill them, and only single numbers are read four at a time.
    #[test]
    fn readers_take_whole_texels() {
        for binding in bindings().filter(|binding| binding.reader.is_some()) {
            let element = binding.element.expect("no image is read");
            let size = element.size();
            assert!([4, 8].contains(&size) || size.is_multiple_of(16), "{}: {size}", binding.name);
            let by_four = binding.texel == 4 && size == 4;
            assert!(by_four || binding.texel == element.texel(), "{}: by four", binding.name);
        }
    }

    #[test]
    fn no_two_bindings_have_a_number_in_common() {
        let numbers: BTreeSet<u32> = bindings().map(|binding| binding.number).collect();
        assert_eq!(numbers.len(), bindings().count());
    }
}

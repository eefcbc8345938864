//! Compiles `glsl/` with shaderc. Only with the feature `compile`.

use crate::{forbid_contraction, source, spirv};

/// What the manifest says of the compiler: the crate's version pins glslang with it.
const COMPILER: &str =
    "shaderc crate 0.10.1, Vulkan 1.1, no optimisation, NoContraction on all float arithmetic";

/// One kernel as the bytes of its module. Not optimised: names stay for the layout test, float
/// operations stay as written, and drivers optimise on their own.
///
/// # Errors
/// What the compiler says, with file and line.
pub fn compile(kernel: &str) -> Result<Vec<u8>, String> {
    let sources = source::with_includes(kernel)?;
    let (stem, definitions) = spirv::source_of(kernel);
    let file = format!("{stem}.comp");
    let compiler = shaderc::Compiler::new().map_err(|e| e.to_string())?;
    let mut options = shaderc::CompileOptions::new().map_err(|e| e.to_string())?;
    options.set_target_env(shaderc::TargetEnv::Vulkan, shaderc::EnvVersion::Vulkan1_1 as u32);
    options.set_optimization_level(shaderc::OptimizationLevel::Zero);
    options.set_warnings_as_errors();
    for name in definitions {
        options.add_macro_definition(name, None);
    }
    options.set_include_callback(|name, _, _, _| {
        let content = sources.get(name).cloned().ok_or(format!("{name}: not in glsl/shared"))?;
        Ok(shaderc::ResolvedInclude { resolved_name: name.to_owned(), content })
    });
    let module = compiler
        .compile_into_spirv(
            &sources[&file],
            shaderc::ShaderKind::Compute,
            &file,
            "main",
            Some(&options),
        )
        .map_err(|e| e.to_string())?;
    let exact = forbid_contraction(module.as_binary());
    Ok(exact.iter().flat_map(|word| word.to_le_bytes()).collect())
}

/// The text of `spirv/manifest.txt`.
///
/// # Errors
/// A source that cannot be read.
pub fn manifest() -> Result<String, String> {
    let mut text = format!("# {COMPILER}\n# kernel, SHA-256 of its source with all its includes\n");
    for name in spirv::NAMES {
        text += &format!("{name} {}\n", source::hash(name)?);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn committed_modules_are_what_the_compiler_makes() {
        for name in spirv::NAMES {
            let path = source::spirv_folder().join(format!("{name}.spv"));
            let committed = std::fs::read(&path).expect("committed module");
            assert!(compile(name).expect("compiles") == committed, "{name}.spv: other bytes");
        }
    }
}

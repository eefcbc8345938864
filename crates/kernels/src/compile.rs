//! Compiles `glsl/` with shaderc. Only with the feature `compile`.

use crate::spirv::{self, Module};
use crate::{forbid_contraction, source, without_unused};

/// What the manifest says of the compiler: the crate's version pins glslang with it.
const COMPILER: &str = "shaderc crate 0.10.1, Vulkan 1.1, no optimisation, NoContraction on all float arithmetic, no \
                        unused resources";

/// One kernel as the bytes of its module. Not optimised: names stay for the layout test, float
/// operations stay as written, and drivers optimise on their own.
///
/// # Errors
/// What the compiler says, with file and line.
pub fn compile(module: &Module) -> Result<Vec<u8>, String> {
    let sources = source::with_includes(module.kernel())?;
    let file = format!("{}.comp", module.kernel());
    let compiler = shaderc::Compiler::new().map_err(|e| e.to_string())?;
    let mut options = shaderc::CompileOptions::new().map_err(|e| e.to_string())?;
    options.set_target_env(shaderc::TargetEnv::Vulkan, shaderc::EnvVersion::Vulkan1_1 as u32);
    options.set_optimization_level(shaderc::OptimizationLevel::Zero);
    options.set_warnings_as_errors();
    for name in module.macros() {
        options.add_macro_definition(name, None);
    }
    options.set_include_callback(|name, _, _, _| {
        let content = sources
            .get(name)
            .cloned()
            .ok_or(format!("{name}: not in glsl/shared or glsl/stages"))?;
        Ok(shaderc::ResolvedInclude { resolved_name: name.to_owned(), content })
    });
    let compiled = compiler
        .compile_into_spirv(
            &sources[&file],
            shaderc::ShaderKind::Compute,
            &file,
            "main",
            Some(&options),
        )
        .map_err(|e| e.to_string())?;
    let exact = forbid_contraction(&without_unused(compiled.as_binary()));
    Ok(exact.iter().flat_map(|word| word.to_le_bytes()).collect())
}

/// The first line of the manifest: what compiles.
#[must_use]
pub fn first_line() -> String {
    format!("# {COMPILER}")
}

/// The text of `spirv/manifest.txt`.
///
/// # Errors
/// A source that cannot be read.
pub fn manifest() -> Result<String, String> {
    let mut text = format!(
        "{}\n# module, SHA-256 of its source with all its includes, without comments\n",
        first_line()
    );
    for (name, module) in spirv::modules() {
        text += &format!("{name} {}\n", source::hash(module)?);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn committed_modules_are_what_the_compiler_makes() {
        for (name, module) in spirv::modules() {
            let path = source::spirv_folder().join(format!("{name}.spv"));
            let committed = std::fs::read(&path).expect("committed module");
            assert!(compile(module).expect("compiles") == committed, "{name}.spv: other bytes");
        }
    }
}

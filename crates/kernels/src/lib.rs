//! Pointillist's compute kernels as SPIR-V, and the host side of their structs.

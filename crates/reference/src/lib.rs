//! The kernels' twins on the CPU, generic over f32 and f64.

//! Pointillist's Vulkan layer: devices, buffers, images, kernels and the recorder.

//! The frontend: plans a render and drives the passes on a device.

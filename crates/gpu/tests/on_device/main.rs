//! The crate on whatever device there is, with validation on: every test ends by asserting that
//! the layer had nothing to say, the destruction of everything included. That it would have
//! spoken is tested beside the code: `a_broken_rule_is_collected` and
//! `a_missing_barrier_is_collected`.
//!
//! Without a Vulkan device or without the layer these tests fail, and say what to install.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests, which fail by panicking")]

mod modules;

use gpu::{
    Bindings, Buffer, Device, DeviceChoice, GpuError, Image, ImageFormat, Instance,
    InstanceOptions, Kernel, PassBuilder, Recorder, Texel,
};
use modules::{INPUT, OUTPUT};
use std::sync::Arc;

/// Runs a test on the default device and asserts that validation was silent.
fn on_device(test: impl FnOnce(&Arc<Device>)) {
    let instance = Instance::new(&InstanceOptions { validation: true });
    let instance = instance.unwrap_or_else(|error| panic!("{error}"));
    let device = Device::open(&instance, &DeviceChoice::Default);
    let device = device.unwrap_or_else(|error| panic!("{error}"));
    test(&device);
    assert_eq!(Arc::strong_count(&device), 1, "the test kept an object of the device");
    drop(device);
    assert_eq!(instance.validation_messages(), Vec::<String>::new());
}

/// A kernel of one of the modules here.
#[expect(unsafe_code, reason = "modules of this test, assembled as the specification says")]
fn kernel(device: &Arc<Device>, name: &'static str, words: Vec<u32>) -> Kernel {
    // SAFETY: the modules here are valid; validation is on and would say if they were not.
    unsafe { Kernel::of_words(device, name, words, Texel::Four) }.unwrap()
}

fn add_kernel(device: &Arc<Device>) -> Kernel {
    kernel(device, "add", modules::add())
}

/// Records `output[i] = input[i] + addend`.
fn add(rec: &mut Recorder, kernel: &Kernel, input: &Buffer, output: &Buffer, addend: u32) {
    let count = (output.bytes() / 4) as u32;
    rec.pass_of(kernel)
        .buffer(INPUT, input)
        .buffer(OUTPUT, output)
        .push(&addend)
        .dispatch([count, 1, 1]);
}

fn read(buffer: &Buffer) -> Vec<u32> {
    let mut values = vec![0; (buffer.bytes() / 4) as usize];
    buffer.read(0, &mut values).unwrap();
    values
}

#[test]
fn what_is_written_is_read_back() {
    on_device(|device| {
        let values: Vec<u32> = (0..1000).map(|i| i * i).collect();
        let buffer = Buffer::from_slice(device, "values", &values).unwrap();
        assert_eq!((buffer.bytes(), buffer.name()), (4000, "values"));
        assert_eq!(read(&buffer), values);

        buffer.write(8, &[[7_u8, 8, 9]]).unwrap();
        let mut bytes = [0_u8; 5];
        buffer.read(7, &mut bytes).unwrap();
        assert_eq!(bytes, [0, 7, 8, 9, 0]);
    });
}

#[test]
fn an_empty_buffer_can_be_bound() {
    on_device(|device| {
        let empty = Buffer::from_slice::<u32>(device, "empty", &[]).unwrap();
        let output = Buffer::from_slice(device, "output", &[9_u32; 4]).unwrap();
        assert_eq!(empty.bytes(), 16);
        empty.write(0, &[1_u32, 2, 3, 4]).unwrap();
        let mut rec = Recorder::new(device).unwrap();
        add(&mut rec, &add_kernel(device), &empty, &output, 10);
        rec.submit().unwrap();
        assert_eq!(read(&output), [11, 12, 13, 14]);
    });
}

#[test]
fn a_chain_of_passes_sees_each_others_writes() {
    on_device(|device| {
        let kernel = add_kernel(device);
        // Not a multiple of the workgroup: the last one is partly idle.
        let values: Vec<u32> = (0..1003).collect();
        let a = Buffer::from_slice(device, "a", &values).unwrap();
        let b = Buffer::new(device, "b", a.bytes()).unwrap();
        let c = Buffer::new(device, "c", a.bytes()).unwrap();
        let mut rec = Recorder::new(device).unwrap();
        add(&mut rec, &kernel, &a, &b, 1); // then read after write
        add(&mut rec, &kernel, &b, &c, 10); // then write after read
        add(&mut rec, &kernel, &c, &b, 100); // then write after write
        add(&mut rec, &kernel, &a, &b, 1000); // and in place
        add(&mut rec, &kernel, &b, &b, 10_000);
        let timings = rec.submit().unwrap();
        assert_eq!(read(&b), (0..1003).map(|i| i + 11_000).collect::<Vec<_>>());
        assert_eq!(read(&c), (0..1003).map(|i| i + 11).collect::<Vec<_>>());

        if device.limits().timestamp_period > 0.0 {
            assert_eq!(timings.passes.len(), 5);
            for (name, milliseconds) in timings.passes {
                assert_eq!(name, "add");
                assert!((0.0..60_000.0).contains(&milliseconds), "{milliseconds} ms");
            }
        }
    });
}

#[test]
fn fills_and_copies_are_ordered_with_passes() {
    on_device(|device| {
        let kernel = add_kernel(device);
        let [a, b] = ["a", "b"].map(|name| Buffer::new(device, name, 1024).unwrap());
        let mut rec = Recorder::new(device).unwrap();
        rec.fill(&a, 0, 1024, 5);
        rec.fill(&a, 4, 8, 6);
        add(&mut rec, &kernel, &a, &b, 1);
        rec.copy(&b, 0, &a, 512, 512);
        rec.copy(&a, 0, &a, 256, 64);
        rec.submit().unwrap();
        let a = read(&a);
        assert_eq!((a[0], a[1], a[2], a[3]), (5, 6, 6, 5));
        assert_eq!((a[64], a[65], a[127]), (5, 6, 5));
        assert_eq!((a[128], a[129], a[130], a[131]), (6, 7, 7, 6));
    });
}

#[test]
fn images_ping_pong() {
    on_device(|device| {
        let kernel = kernel(device, "step_image", modules::step_image());
        assert_eq!(kernel.group_size(), [8, 4, 1]);

        let size = [13, 7]; // no multiple of the workgroup
        let images = ["ping", "pong"]
            .map(|name| Image::new(device, name, size, ImageFormat::Rgba32Uint).unwrap());
        assert_ne!(images[0].id(), images[1].id());
        assert_eq!(images[0].size(), size);
        assert!(images[0].bytes() >= 13 * 7 * 16);
        let pixels = [0, 1].map(|_| Buffer::new(device, "pixels", 13 * 7 * 16).unwrap());

        // The content of a new image is undefined: a first step shows what it was.
        let mut rec = Recorder::new(device).unwrap();
        rec.copy_image(&images[0], &pixels[0], 0);
        for step in 0..5 {
            rec.pass_of(&kernel)
                .image(INPUT, &images[step % 2])
                .image(OUTPUT, &images[(step + 1) % 2])
                .dispatch([13, 7, 1]);
        }
        rec.copy_image(&images[1], &pixels[1], 0);
        rec.submit().unwrap();

        let [before, after] = pixels.each_ref().map(read);
        for y in 0..7 {
            for x in 0..13 {
                let at = (y * 13 + x) as usize * 4;
                let step = [x, y, 0, 1];
                for i in 0..4 {
                    let expected = before[at + i].wrapping_add(5 * step[i]);
                    assert_eq!(after[at + i], expected, "pixel {x}, {y}, value {i}");
                }
            }
        }
    });
}

#[test]
fn texel_buffers_have_the_modules_type() {
    on_device(|device| {
        let kernel = kernel(device, "fetch", modules::fetch());
        // Bits that a float format could change: a signalling NaN and a subnormal.
        let bits = [0x7f80_0001, 0x0000_0001, 0xffff_ffff, 42];
        let texels: Vec<[u32; 4]> = bits.iter().map(|&y| [1, y, 3, 4]).collect();
        let input = Buffer::from_slice(device, "texels", &texels).unwrap();
        let output = Buffer::new(device, "output", 16).unwrap();
        let mut rec = Recorder::new(device).unwrap();
        rec.pass_of(&kernel).buffer(INPUT, &input).buffer(OUTPUT, &output).dispatch([4, 1, 1]);
        rec.submit().unwrap();
        assert_eq!(read(&output), bits);
    });
}

#[test]
fn indirect_counts_may_be_written_by_a_pass() {
    on_device(|device| {
        let kernel = add_kernel(device);
        // One workgroup too few for the output: its last 64 values stay.
        let zeros = Buffer::from_slice(device, "zeros", &[0_u32, 0, 0, 0]).unwrap();
        let counts = Buffer::new(device, "counts", 16).unwrap();
        let input = Buffer::from_slice(device, "input", &[1_u32; 192]).unwrap();
        let output = Buffer::from_slice(device, "output", &[0_u32; 192]).unwrap();
        let mut rec = Recorder::new(device).unwrap();
        add(&mut rec, &kernel, &zeros, &counts, 1);
        rec.fill(&counts, 4, 4, 2);
        rec.pass_of(&kernel)
            .buffer(INPUT, &input)
            .buffer(OUTPUT, &output)
            .push(&5_u32)
            .dispatch_indirect(&counts, 4); // 2, 1, 1
        rec.submit().unwrap();
        assert_eq!(read(&output), [[6; 128].as_slice(), &[0; 64]].concat());
    });
}

#[test]
fn a_recorder_is_used_again_and_again() {
    on_device(|device| {
        let kernel = add_kernel(device);
        let [a, b] = ["a", "b"].map(|name| Buffer::from_slice(device, name, &[0_u32; 64]).unwrap());
        let mut rec = Recorder::new(device).unwrap();
        for _ in 0..300 {
            add(&mut rec, &kernel, &a, &b, 1);
            add(&mut rec, &kernel, &b, &a, 1);
            rec.submit().unwrap();
        }
        assert_eq!(read(&a), [600; 64]);
        assert_eq!(rec.submit().unwrap(), gpu::Timings::default(), "nothing recorded");
    });
}

/// More passes than one query pool times, and more sets than the cache keeps.
#[test]
fn long_recordings_with_ever_new_buffers_work() {
    on_device(|device| {
        let kernel = add_kernel(device);
        let mut rec = Recorder::new(device).unwrap();
        for _ in 0..4 {
            let mut last = Buffer::from_slice(device, "first", &[0_u32; 4]).unwrap();
            for _ in 0..300 {
                let next = Buffer::new(device, "next", 16).unwrap();
                add(&mut rec, &kernel, &last, &next, 1);
                last = next; // drops the one before while the recording still uses it
            }
            let timings = rec.submit().unwrap();
            assert_eq!(read(&last), [300; 4]);
            assert!([0, 300].contains(&timings.passes.len()), "{}", timings.passes.len());
        }
    });
}

#[test]
fn timing_can_be_turned_off_and_on() {
    on_device(|device| {
        let kernel = add_kernel(device);
        let buffer = Buffer::from_slice(device, "buffer", &[0_u32; 4]).unwrap();
        let mut rec = Recorder::new(device).unwrap();
        let has_timestamps = device.limits().timestamp_period > 0.0;
        for (on, rows) in [(false, 0), (true, if has_timestamps { 3 } else { 0 })] {
            rec.set_timing(on);
            add(&mut rec, &kernel, &buffer, &buffer, 1);
            rec.fill(&buffer, 0, 4, 0); // between passes, and charged to neither
            add(&mut rec, &kernel, &buffer, &buffer, 1);
            add(&mut rec, &kernel, &buffer, &buffer, 1);
            assert_eq!(rec.submit().unwrap().passes.len(), rows);
        }
        assert_eq!(read(&buffer), [2, 6, 6, 6]);
    });
}

#[test]
fn a_recording_outlives_the_handles_it_was_made_with() {
    on_device(|device| {
        let mut rec = Recorder::new(device).unwrap();
        let output = Buffer::new(device, "output", 64).unwrap();
        {
            let input = Buffer::from_slice(device, "input", &[3_u32; 16]).unwrap();
            add(&mut rec, &add_kernel(device), &input, &output, 4);
        }
        rec.submit().unwrap();
        assert_eq!(read(&output), [7; 16]);
    });
}

#[test]
fn dropping_a_recorder_with_work_in_it_is_fine() {
    on_device(|device| {
        let buffer = Buffer::from_slice(device, "buffer", &[1_u32; 4]).unwrap();
        let mut rec = Recorder::new(device).unwrap();
        rec.fill(&buffer, 0, 16, 9);
        drop(rec);
        assert_eq!(read(&buffer), [1; 4]);
    });
}

#[test]
fn a_buffer_that_is_too_large_is_refused_by_name_and_limit() {
    on_device(|device| {
        let limit = device.limits().max_storage_buffer_range;
        let message = Buffer::new(device, "points", limit + 1).unwrap_err().to_string();
        for part in ["'points'".to_owned(), (limit + 1).to_string(), limit.to_string()] {
            assert!(message.contains(&part), "{message} lacks {part}");
        }
    });
}

#[test]
fn an_image_that_is_too_large_is_refused_by_name_and_limit() {
    on_device(|device| {
        let limit = device.limits().max_image_dimension_2d;
        let error = Image::new(device, "hits", [4, limit + 1], ImageFormat::Rgba32Float);
        let message = error.unwrap_err().to_string();
        for part in ["'hits'".to_owned(), format!("4 x {}", limit + 1), limit.to_string()] {
            assert!(message.contains(&part), "{message} lacks {part}");
        }
    });
}

/// The largest square image: more than some devices hold, and less than others do.
#[test]
fn an_image_either_fits_or_is_refused_by_name_and_size() {
    on_device(|device| {
        let side = device.limits().max_image_dimension_2d;
        let bytes = u64::from(side) * u64::from(side) * ImageFormat::PIXEL_BYTES;
        match Image::new(device, "hits", [side, side], ImageFormat::Rgba32Float) {
            Ok(image) => assert!(image.bytes() >= bytes),
            Err(error) => {
                let message = error.to_string();
                assert!(message.contains("out of device memory for 'hits'"), "{message}");
                assert!(message.contains(&bytes.to_string()), "{message}");
            }
        }
    });
}

#[test]
fn a_dispatch_that_is_too_large_fails_at_submit_and_only_then() {
    on_device(|device| {
        let kernel = add_kernel(device);
        let buffer = Buffer::from_slice(device, "buffer", &[1_u32; 4]).unwrap();
        let limit = device.limits().max_compute_workgroup_count[1];
        let mut rec = Recorder::new(device).unwrap();
        let wide = |rec: &mut Recorder, y| {
            rec.pass_of(&kernel)
                .buffer(INPUT, &buffer)
                .buffer(OUTPUT, &buffer)
                .push(&0_u32)
                .dispatch([1, y, 1]);
        };
        if let Some(too_many) = limit.checked_add(1) {
            wide(&mut rec, too_many);
            rec.fill(&buffer, 0, 16, 2);
            let message = rec.submit().unwrap_err().to_string();
            assert!(message.contains("'add'") && message.contains("along y"), "{message}");
            assert!(message.contains(&limit.to_string()), "{message}");
        }
        assert_eq!(read(&buffer), [1; 4], "nothing ran");
        wide(&mut rec, 0);
        rec.fill(&buffer, 0, 16, 3);
        rec.submit().unwrap();
        assert_eq!(read(&buffer), [3; 4], "the recorder works again");
    });
}

#[test]
fn an_unknown_device_is_refused_with_a_list() {
    let instance = Instance::new(&InstanceOptions::default()).unwrap();
    let devices = instance.devices().unwrap();
    let choice = DeviceChoice::Named("no such device".to_owned());
    let error = Device::open(&instance, &choice).unwrap_err();
    assert!(matches!(error, GpuError::UnknownDevice { .. }) && error.is_no_device());
    let message = error.to_string();
    assert!(message.contains("'no such device'"), "{message}");
    for device in devices {
        assert!(message.contains(&device.name), "{message} lacks {}", device.name);
    }
}

#[test]
fn devices_can_be_opened_by_index_and_by_name() {
    let instance = Instance::new(&InstanceOptions::default()).unwrap();
    let default = instance.default_device().unwrap();
    assert!(!default.reason.is_empty());
    let info = instance.devices().unwrap().swap_remove(default.index);
    assert!(!info.driver.is_empty() && info.api_version >= (1, 1, 0), "{info:?}");
    let by_index = DeviceChoice::Named(default.index.to_string());
    for choice in [DeviceChoice::Default, by_index, DeviceChoice::Named(info.name.to_uppercase())] {
        let device = Device::open(&instance, &choice).unwrap();
        assert_eq!(device.info(), &info);
        assert!(device.limits().heap_bytes > 0);
    }
}

#[test]
fn threads_may_share_a_device() {
    on_device(|device| {
        let kernel = add_kernel(device);
        std::thread::scope(|scope| {
            for start in 0..3_u32 {
                let kernel = &kernel;
                scope.spawn(move || {
                    let buffer = Buffer::from_slice(device, "mine", &[start; 64]).unwrap();
                    let mut rec = Recorder::new(device).unwrap();
                    for _ in 0..20 {
                        add(&mut rec, kernel, &buffer, &buffer, 1);
                        rec.submit().unwrap();
                    }
                    assert_eq!(read(&buffer), [start + 20; 64]);
                });
            }
        });
    });
}

/// What a submission says of a pass of the kernel `add` that was recorded so.
fn wrong(record: impl FnOnce(PassBuilder<'_>, &Buffer, &Image)) -> String {
    let mut said = String::new();
    on_device(|device| {
        let kernel = add_kernel(device);
        let buffer = Buffer::new(device, "buffer", 16).unwrap();
        let image = Image::new(device, "image", [4, 4], ImageFormat::Rgba32Uint).unwrap();
        let mut rec = Recorder::new(device).unwrap();
        record(rec.pass_of(&kernel), &buffer, &image);
        said = rec.submit().unwrap_err().to_string();
        rec.submit().unwrap();
    });
    said
}

/// Numbers 0 and 1 are those of points and neighbours in the project's kernels, and are named so.
#[test]
fn what_a_pass_lacks_or_has_too_much_is_named() {
    let missing = wrong(|pass, buffer, _| {
        pass.buffer(INPUT, buffer).push(&0_u32).dispatch([1, 1, 1]);
    });
    assert!(missing.starts_with("pass 'add': NEIGHBORS (1) is bound to nothing"), "{missing}");
    let image = wrong(|pass, buffer, image| {
        pass.image(INPUT, image).buffer(OUTPUT, buffer).push(&0_u32).dispatch([1, 1, 1]);
    });
    assert!(image.starts_with("pass 'add': POINTS (0) is a buffer, and an image"), "{image}");
    let other = wrong(|pass, buffer, _| {
        let table = Bindings::new().buffer(INPUT, buffer).buffer(OUTPUT, buffer);
        pass.buffer(1000, buffer).bind(&table).push(&0_u32).dispatch([1, 1, 1]);
    });
    assert!(other.starts_with("pass 'add': binding 1000 is bound, and the kernel"), "{other}");
    let pushed = wrong(|pass, buffer, _| {
        let table = Bindings::new().buffer(INPUT, buffer).buffer(OUTPUT, buffer);
        pass.bind(&table).push(&[0_u32; 2]).dispatch([1, 1, 1]);
    });
    assert!(pushed.starts_with("pass 'add': 8 bytes of push constants, and"), "{pushed}");
}

/// A table may have more than a kernel uses, and what is bound before it stays.
#[test]
fn a_table_binds_what_is_left() {
    on_device(|device| {
        let kernel = add_kernel(device);
        let input = Buffer::from_slice(device, "input", &[1_u32, 2, 3, 4]).unwrap();
        let [output, unused] = [0, 1].map(|_| Buffer::from_slice(device, "zeros", &[0_u32; 4]));
        let (output, unused) = (output.unwrap(), unused.unwrap());
        let table = Bindings::new().buffer(INPUT, &unused).buffer(OUTPUT, &output);
        let table = table.buffer(70, &unused);
        let mut rec = Recorder::new(device).unwrap();
        let pass = rec.pass_of(&kernel).buffer(INPUT, &input).bind(&table);
        pass.push(&7_u32).dispatch([4, 1, 1]);
        rec.submit().unwrap();
        assert_eq!(read(&output), [8, 9, 10, 11]);
    });
}

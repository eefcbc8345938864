//! The harness of the end-to-end tests.
//!
//! Every device that it opens has the validation layer on, synchronisation validation included, and
//! dropping the last [`Bench`] fails the test on any message.
#![forbid(unsafe_code)]
#![allow(
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking, and says what it skips"
)]

pub mod analytic;
pub mod judge;
mod near;
pub mod scenes;
mod shapes;

pub use shapes::{
    fibonacci_sphere, grid_points, moved, random, set_of, wavy_sheet, with_attribute,
};

use film::Film;
use gpu::{Device, DeviceChoice, Instance, InstanceOptions};
use kernels::layout;
use plan::{Picture, Plan, SceneImages};
use points::{PointSet, Unwatched};
use reference::Reference;
use render::Renderer;
use scene::{Scene, Up};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Devices that give the same bits as the CPU, by a part of their names: so it was measured (docs/testing.md). Others
/// may contract or reorder, and differ in the last of them.
const EXACT: [&str; 2] = ["llvmpipe", "SwiftShader Device (Subzero)"];

/// Whether the device of this process is none of these.
static IS_OTHER: AtomicBool = AtomicBool::new(false);
/// Whether it is another than lavapipe, and may flush numbers below 1.2e-38 to zero.
static MAY_FLUSH: AtomicBool = AtomicBool::new(false);

/// Whether pictures of the device are the CPU's to the bit. Meaningful once a [`Bench`] is open.
#[must_use]
pub fn is_exact() -> bool {
    !IS_OTHER.load(Ordering::Relaxed)
}

/// A device under validation, which the tests of a process share while any of them uses it: it keeps its
/// pipelines, which some drivers take minutes for.
pub struct Bench {
    device: Arc<Device>,
    _user: User,
}

/// What tests share, and how many of them do. Locked while it opens and while it closes, so that no instance
/// is made while another is being destroyed.
static SHARED: Mutex<Shared> = Mutex::new(Shared { watched: None, users: 0 });

struct Shared {
    watched: Option<Watched>,
    users: usize,
}

/// Held by the one test whose turn at the device it is.
static TURN: Mutex<()> = Mutex::new(());

/// One that shares, counted.
struct User;

/// Looks at the validation layer's messages when the last test lets go of it.
struct Watched {
    /// `None` once it is destroyed.
    device: Option<Arc<Device>>,
    instance: Arc<Instance>,
    /// Kept until the process ends, which nothing looks at: lavapipe tells of what outlives a device.
    is_slow: bool,
}

impl Bench {
    /// Opens the default device with validation on.
    #[must_use]
    pub fn open() -> Self {
        let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
        let watched = shared.watched.get_or_insert_with(Watched::open);
        let device = watched.device.clone().expect("a device until the last test ends");
        shared.users += 1;
        Self { device, _user: User }
    }

    /// Runs work on the device that a user would get, one test's at a time: the queue would do no more, and
    /// the validation layer (1.3.239, `vkDestroyCommandPool` on two threads) has crashed where recorders of two
    /// tests ended together. Work must not ask for another turn.
    pub fn with_device<T>(&self, work: impl FnOnce(&Arc<Device>) -> T) -> T {
        let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        work(&self.device)
    }

    /// Builds and traces a plan on the device.
    #[must_use]
    pub fn render(&self, plan: &Plan) -> Rendered {
        self.render_within(plan, None)
    }

    /// The same; in each pass, a ray may spend no more than so many loop iterations if a number is given.
    #[must_use]
    pub fn render_within(&self, plan: &Plan, work: Option<u32>) -> Rendered {
        self.with_device(|device| rendered(device, plan, work))
    }
}

fn rendered(device: &Arc<Device>, plan: &Plan, work: Option<u32>) -> Rendered {
    let mut renderer = Renderer::new(device, &Arc::new(plan.clone()), &Unwatched).expect("builds");
    if let Some(work) = work {
        renderer.set_budget(work);
    }
    let (picture, stats) = renderer.frame(&Unwatched).expect("renders");
    let surfaces = renderer.surfaces();
    let mut polynomials =
        vec![<layout::Polynomial as bytemuck::Zeroable>::zeroed(); plan.cloud.points.len()];
    surfaces.polynomials.read(0, &mut polynomials).expect("polynomials");
    let listed = if surfaces.is_listed { surfaces.grids.cell_count() } else { 0 };
    let mut cells = vec![[0u32; 2]; listed as usize];
    surfaces.cells.read(0, &mut cells).expect("cells");
    let listed = cells.iter().filter(|range| range[0] < range[1]).map(|range| range[1]).max();
    let mut slots = vec![0u32; listed.unwrap_or(0) as usize];
    surfaces.slots.read(0, &mut slots).expect("slots");
    Rendered {
        polynomials,
        cells,
        slots,
        passes: stats.passes,
        tests: picture.tests,
        has_tree: surfaces.tree.is_some(),
        film: picture.finish(),
    }
}

impl Watched {
    fn open() -> Self {
        let instance = Instance::new(&InstanceOptions { validation: true }).unwrap_or_else(|e| {
            panic!("no Vulkan with validation: {e}; tools/test installs what is missing")
        });
        let device = Device::open(&instance, &DeviceChoice::Default).expect("a usable device");
        let name = &device.info().name;
        let is_other = !EXACT.iter().any(|exact| name.contains(exact));
        if is_other && !IS_OTHER.swap(true, Ordering::Relaxed) {
            said(&format!("on {name}, with tolerances instead of bits (docs/testing.md)"));
        }
        let is_slow = !name.contains("llvmpipe");
        MAY_FLUSH.store(is_slow, Ordering::Relaxed);
        Self { device: Some(device), instance, is_slow }
    }

    fn assert_silence(&self) {
        let messages = self.instance.validation_messages();
        if !std::thread::panicking() {
            assert!(messages.is_empty(), "validation messages:\n{}", messages.join("\n"));
        }
    }
}

impl Drop for User {
    fn drop(&mut self) {
        let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
        shared.users -= 1;
        if shared.users > 0 {
            return;
        }
        match &shared.watched {
            // It took minutes to make its pipelines, and the next test wants them.
            Some(watched) if watched.is_slow => watched.assert_silence(),
            _ => drop(shared.watched.take()),
        }
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        // The layer tells of objects that outlive their device.
        drop(self.device.take());
        self.assert_silence();
    }
}

/// What a render left behind, on a device or on the CPU.
pub struct Rendered {
    /// By slot.
    pub polynomials: Vec<layout::Polynomial>,
    /// Range of each cell in `slots`; none where no ray goes through the grid, and nothing is looked up in it.
    pub cells: Vec<[u32; 2]>,
    /// Points of the cells.
    pub slots: Vec<u32>,
    /// Dispatches of `grid_trace`.
    pub passes: u32,
    /// Points tested by all rays.
    pub tests: u64,
    /// Whether there is a tree, through which rays meet others than through the grid.
    pub has_tree: bool,
    /// The picture.
    pub film: Film,
}

/// Renders a plan with the f32 twin.
#[must_use]
pub fn render_twin(plan: &Plan) -> Rendered {
    let reference = Reference::<f32>::new(plan, &Unwatched).expect("nobody interrupts");
    let picture: Picture = reference.frame(plan, &Unwatched).expect("nobody interrupts");
    Rendered {
        // Behind those of the points come stand-ins of isosurfaces.
        polynomials: (reference.polynomials.iter().take(plan.cloud.points.len()))
            .map(|&p| p.into())
            .collect(),
        cells: reference.lists.cells,
        slots: reference.lists.slots,
        passes: 1,
        tests: picture.tests,
        has_tree: false,
        film: picture.finish(),
    }
}

/// A plan of a scene text whose objects have these point sets, in order. A text without objects gets
/// one object.
#[must_use]
pub fn plan_of(scene_text: &str, sets: &[PointSet]) -> Plan {
    plan_with(scene_text, sets, &SceneImages::default())
}

/// The same with the images that the text names.
#[must_use]
pub fn plan_with(scene_text: &str, sets: &[PointSet], images: &SceneImages) -> Plan {
    let mut text = scene_text.to_owned();
    if !text.contains("[[objects]]") {
        text += "\n[[objects]]\npoints = \"generated.ply\"\n";
    }
    let scene = Scene::from_toml(&text, Path::new("generated.toml"), &[]).expect("a valid scene");
    let sets: Vec<Arc<PointSet>> = sets.iter().cloned().map(Arc::new).collect();
    Plan::new(&scene, &sets, images, None, Up::Y).expect("a plan")
}

/// Fails unless both are the same to the bit: polynomials, picture, the grid where both have lists, and points tested
/// where rays of both went the same way. On devices that are not exact, unless they are near ([`near`]).
pub fn assert_same_bits(name: &str, a: &Rendered, b: &Rendered) {
    if !is_exact() {
        return near::assert_near(name, a, b);
    }
    for (slot, (p, q)) in a.polynomials.iter().zip(&b.polynomials).enumerate() {
        assert!(
            bytemuck::bytes_of(p) == bytemuck::bytes_of(q),
            "{name}: polynomial {slot}:\n{p:?}\n{q:?}"
        );
    }
    assert_eq!(a.polynomials.len(), b.polynomials.len(), "{name}: polynomials");
    if !(a.cells.is_empty() || b.cells.is_empty()) {
        assert!(a.cells == b.cells, "{name}: cells differ");
        assert!(a.slots == b.slots, "{name}: points of the cells differ");
    }
    assert_same_film(name, &a.film, &b.film);
    if a.has_tree == b.has_tree {
        assert_eq!(a.tests, b.tests, "{name}: points tested");
    }
}

/// The same where sums lie below the least normal number, 1.2e-38: which lavapipe and the CPU keep, and others may
/// flush to zero. On those both are near.
pub fn assert_same_bits_unless_flushed(name: &str, a: &Rendered, b: &Rendered) {
    match MAY_FLUSH.load(Ordering::Relaxed) {
        true => near::assert_near(name, a, b),
        false => assert_same_bits(name, a, b),
    }
}

/// Fails unless both films are the same to the bit; on devices that are not exact, unless they are near.
pub fn assert_same_film(name: &str, a: &Film, b: &Film) {
    assert_eq!((a.size, a.window), (b.size, b.window), "{name}: size");
    if !is_exact() {
        return near::assert_near_films(name, a, b);
    }
    fn planes(film: &Film) -> Vec<(&str, Vec<u8>, usize)> {
        let mut planes = vec![
            ("object", bytemuck::cast_slice(&film.object).to_vec(), 4),
            ("Z", bytemuck::cast_slice(&film.depth).to_vec(), 4),
            ("P", bytemuck::cast_slice(&film.position).to_vec(), 12),
            ("N", bytemuck::cast_slice(&film.normal).to_vec(), 12),
            ("RGBA", bytemuck::cast_slice(&film.color).to_vec(), 16),
        ];
        if let Some(alpha) = &film.channel_alpha {
            planes.push(("AR AG AB", bytemuck::cast_slice(alpha).to_vec(), 12));
        }
        let extra = film.extra.iter();
        planes.extend(
            extra.map(|(name, plane)| (name.as_str(), bytemuck::cast_slice(plane).to_vec(), 4)),
        );
        planes
    }
    assert_eq!(a.channel_alpha.is_some(), b.channel_alpha.is_some(), "{name}: AR AG AB");
    assert_eq!(a.extra.len(), b.extra.len(), "{name}: extra channels");
    for ((plane, left, size), (_, right, _)) in planes(a).into_iter().zip(planes(b)) {
        let differing: Vec<usize> = left
            .chunks(size)
            .zip(right.chunks(size))
            .enumerate()
            .filter_map(|(at, (l, r))| (l != r).then_some(at))
            .collect();
        if let Some(&first) = differing.first() {
            let values = |bytes: &[u8]| -> Vec<f32> {
                bytes[first * size..(first + 1) * size]
                    .chunks(4)
                    .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                    .collect()
            };
            let width = a.window.width as usize;
            panic!(
                "{name}: {plane} differs in {} of {} pixels, first at ({}, {}): {:?} and {:?}",
                differing.len(),
                left.len() / size,
                first % width,
                first / width,
                values(&left),
                values(&right),
            );
        }
    }
}

/// A file of the collected test data, whose folder `POINTILLIST_DATA` names, or `None`, said loudly, where it is
/// missing.
#[must_use]
pub fn shared_data(file: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("POINTILLIST_DATA").map(PathBuf::from);
    let path = folder.map(|folder| folder.join(file)).filter(|path| path.exists());
    if path.is_none() {
        said(&format!("SKIPPED: {file}: POINTILLIST_DATA names no folder with it"));
    }
    path
}

/// A line that is seen although the test passes: the test runner swallows what eprintln! prints.
pub fn said(line: &str) {
    let line = format!("{line}\n");
    std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes()).expect("stderr");
}

/// Background pixels all of whose four neighbours show a surface.
#[must_use]
pub fn pinholes(film: &Film) -> usize {
    let (width, height) = (film.window.width as usize, film.window.height as usize);
    let hit = |x: usize, y: usize| film.object[y * width + x] >= 0.0;
    (1..height.max(2) - 1)
        .flat_map(|y| (1..width.max(2) - 1).map(move |x| (x, y)))
        .filter(|&(x, y)| {
            !hit(x, y) && hit(x - 1, y) && hit(x + 1, y) && hit(x, y - 1) && hit(x, y + 1)
        })
        .count()
}

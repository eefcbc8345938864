//! Pipelines made on threads of their own, while points are read and surfaces built: drivers take long for some,
//! and on one core for each.

use crate::engine::Engine;
use crate::{interrupt, threads};
use gpu::{Device, Kernel};
use plan::Plan;
use render::Renderer;
use scene::{Boundary, Object, Scene, SurfaceKind};
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, JoinHandle};

/// There are some twenty pipelines, and one takes half of the time.
const MOST_THREADS: usize = 8;

/// The threads, and what they have yet to do. They end with it, each after the pipeline that it is at: what fails
/// meanwhile is told after that.
pub struct Ahead {
    device: Option<Arc<Device>>,
    list: Arc<List>,
    threads: Vec<JoinHandle<()>>,
}

#[derive(Default)]
struct List {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    kernels: VecDeque<Kernel>,
    closed: bool,
}

impl Ahead {
    /// One thread a core, up to eight; none for the CPU reference, nor where the system has no more.
    pub fn new(engine: &Engine) -> Self {
        let list = Arc::new(List::default());
        let device = match engine {
            Engine::Gpu(device) => Some(Arc::clone(device)),
            Engine::Reference | Engine::ReferenceF64 => None,
        };
        let cores = || threads::count().min(MOST_THREADS);
        let count = device.as_ref().map_or(0, |_| cores());
        let thread = |_| {
            let list = Arc::clone(&list);
            Builder::new().spawn(move || list.work_off()).ok()
        };
        Self { device, threads: (0..count).map_while(thread).collect(), list }
    }

    /// Adds what the fits of a scene's points will take.
    pub fn fits(&self, scene: &Scene) {
        let carries_surface = |object: &&Object| {
            object.volume.as_ref().is_none_or(|volume| volume.boundary != Boundary::None)
        };
        let objects = scene.objects.iter().filter(|object| !object.is_ground());
        let objects = objects.filter(carries_surface);
        let fitted = |object: &Object| match object.surface.kind {
            SurfaceKind::Points => Some(object.surface.neighbors.count()),
            // Unless the file has normals.
            SurfaceKind::Discs(_) => Some(points::Shapes::NEIGHBORS),
            SurfaceKind::Spheres(_) => None,
        };
        let mut neighbors: Vec<_> = objects.filter_map(fitted).collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        for count in neighbors {
            self.add(|device| {
                let modules = points::device::modules_of_fits(device, count).into_iter();
                Ok(modules
                    .map(|module| Kernel::new(device, module, None))
                    .collect::<Result<_, _>>()?)
            });
        }
    }

    /// Adds what the rest of a build and a picture will take.
    pub fn picture(&self, plan: &Plan) {
        self.add(|device| Renderer::likely_kernels(device, plan));
    }

    /// What cannot be made is an error of the work that needs it, and of nothing here.
    fn add(&self, kernels: impl FnOnce(&Arc<Device>) -> Result<Vec<Kernel>, render::RenderError>) {
        if let Some(Ok(kernels)) = self.device.as_ref().map(kernels) {
            self.list.lock().kernels.extend(kernels);
            self.list.changed.notify_all();
        }
    }
}

impl Drop for Ahead {
    fn drop(&mut self) {
        self.list.lock().closed = true;
        self.list.changed.notify_all();
        for thread in self.threads.drain(..) {
            // `make_ahead` panics nowhere; if it did, the work that needs the pipeline would say so.
            let _ = thread.join();
        }
    }
}

impl List {
    fn work_off(&self) {
        while let Some(kernel) = self.next() {
            // The pass that uses it says what is wrong with it.
            if interrupt::beside(|| kernel.make_ahead()).is_none() {
                return;
            }
        }
    }

    /// The next kernel, waited for; `None` at the end.
    fn next(&self) -> Option<Kernel> {
        let mut state = self.lock();
        loop {
            if state.closed {
                return None;
            }
            if let Some(kernel) = state.kernels.pop_front() {
                return Some(kernel);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

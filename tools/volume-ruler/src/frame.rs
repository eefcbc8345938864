//! A picture: packets of camera rays, for which points are sought together, on some threads.

use crate::cells::Cells;
use crate::direct;
use crate::gather::{self, Block, Counts, Near, PLACES, Points};
use crate::transfer::Transfer;
use crate::way::{End, Light, Way};
use kernels::layout::{CELL_KINDS, CELL_NOTHING, CameraParams, NONE, ORTHOGRAPHIC, VolumeInfo};
use plan::{Plan, Volumes};
use reference::camera_rays::camera_ray;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pixels along the side of a block that a thread takes.
const SIDE: u32 = 16;

/// How scalars are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum How {
    /// Blocks of places, eight points at a time, where the processor can.
    Fast,
    /// The same, and counts what is done.
    Counted,
    /// Blocks of places, in plain Rust.
    Plain,
    /// In f64, place by place, wherever a place is.
    Direct,
}

/// The volumes of a scene.
pub struct Field<'a> {
    pub volumes: &'a Volumes,
    pub cells: Vec<Cells>,
    pub transfers: Vec<Transfer>,
    camera: CameraParams,
    filter: &'a [f32],
    /// Pixels along the side of a packet.
    packet: u32,
}

impl<'a> Field<'a> {
    /// Packets of `packet` pixels a side, or of as many as lie within the reach of a point where the nearest volume is.
    pub fn of(plan: &'a Plan, a_reach: f64, packet: Option<u32>) -> Self {
        let volumes = &plan.volumes;
        let packet = packet.unwrap_or_else(|| packet_of(&plan.camera, &volumes.infos));
        let each = || volumes.infos.iter();
        Self {
            volumes,
            cells: each().map(|info| Cells::of(info, volumes, a_reach)).collect(),
            transfers: each().map(|info| Transfer::of(info, volumes)).collect(),
            camera: plan.camera_of(&plan.window, 0),
            filter: &plan.filter,
            packet,
        }
    }

    /// The light of every pixel whose column and row are multiples of `every`.
    /// Third: seconds of processors that it took, where the system tells.
    pub fn render(&self, how: How, threads: usize, every: u32) -> (Vec<Light>, Counts, f64) {
        let size = self.camera.tile_size.map(|n| n.div_ceil(every));
        let blocks = size.map(|n| n.div_ceil(SIDE) as usize);
        let next = AtomicUsize::new(0);
        let work = || {
            let mut packet = Packet::new(self, how);
            let mut lights = Vec::new();
            loop {
                let block = next.fetch_add(1, Ordering::Relaxed);
                if block >= blocks[0] * blocks[1] {
                    return (lights, packet.counts, seconds_of_thread());
                }
                let corner = [block % blocks[0], block / blocks[0]].map(|at| at as u32 * SIDE);
                for at in 0..(SIDE / self.packet).pow(2) {
                    let across = SIDE / self.packet;
                    let at = [at % across, at / across].map(|at| at * self.packet);
                    let low = [0, 1].map(|i| (corner[i] + at[i]).min(size[i]));
                    let high = [0, 1].map(|i| (low[i] + self.packet).min(size[i]));
                    let rows = low[1]..high[1];
                    let pixels = rows.flat_map(|y| (low[0]..high[0]).map(move |x| [x, y]));
                    packet.follow_all(pixels, every, |[x, y], light| {
                        lights.push(((y * size[0] + x) as usize, light));
                    });
                }
            }
        };
        let mut picture = vec![Light::default(); (size[0] * size[1]) as usize];
        let (mut counts, mut seconds) = (Counts::default(), 0.0);
        std::thread::scope(|scope| {
            let all: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
            for (lights, own, time) in all.into_iter().filter_map(|thread| thread.join().ok()) {
                lights.into_iter().for_each(|(at, light)| picture[at] = light);
                counts.add(own);
                seconds += time;
            }
        });
        (picture, counts, seconds)
    }
}

fn packet_of(camera: &CameraParams, infos: &[VolumeInfo]) -> u32 {
    let of = |info: &VolumeInfo| {
        let middle = [0, 1, 2].map(|i| 0.5 * (info.grid.origin[i] + info.high[i]));
        let depth: f32 = (0..3).map(|i| (middle[i] - camera.eye[i]) * camera.forward[i]).sum();
        let away = if camera.projection == ORTHOGRAPHIC { 1.0 } else { depth.max(0.0) };
        info.square_radius.sqrt() / (camera.scale * away)
    };
    let pixels = infos.iter().map(of).fold(8.0, f32::min);
    [8, 4, 2].into_iter().find(|&side| side as f32 <= pixels).unwrap_or(1)
}

/// What this thread has used of a processor, where Linux tells; else nothing.
fn seconds_of_thread() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|word| word.parse().ok()).map_or(0.0, |ns: f64| 1e-9 * ns)
}

/// A ray on its way.
struct Ray {
    pixel: [u32; 2],
    origin: [f64; 3],
    direction: [f64; 3],
    way: Way,
    light: Light,
    goes_on: bool,
    /// Of each volume, at the last place of the block before.
    last: Vec<End>,
    /// Of each volume, in this block.
    ends: Vec<[End; PLACES]>,
    /// Places of this block whose scalars are asked for.
    wanted: u32,
}

/// Rays side by side, and what a thread keeps from one to the next.
struct Packet<'a> {
    field: &'a Field<'a>,
    how: How,
    is_wide: bool,
    rays: Vec<Ray>,
    points: Points,
    near: Near,
    counts: Counts,
}

impl<'a> Packet<'a> {
    fn new(field: &'a Field<'a>, how: How) -> Self {
        #[cfg(target_arch = "x86_64")]
        let is_wide = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        #[cfg(not(target_arch = "x86_64"))]
        let is_wide = false;
        let is_wide = is_wide && matches!(how, How::Fast | How::Counted);
        Self {
            field,
            how,
            is_wide,
            rays: vec![],
            points: Points::default(),
            near: Near::default(),
            counts: Counts::default(),
        }
    }

    /// Hands out the light of some pixels.
    fn follow_all(
        &mut self,
        pixels: impl Iterator<Item = [u32; 2]>,
        every: u32,
        mut done: impl FnMut([u32; 2], Light),
    ) {
        let field = self.field;
        debug_assert_eq!(field.camera.sample_index, NONE);
        let mut count = 0;
        for pixel in pixels {
            let place = pixel.map(|at| at * every);
            let (origin, direction) = if self.how == How::Direct {
                let ray = camera_ray::<f64>(&field.camera, field.filter, place);
                (ray.origin.0, ray.direction.0)
            } else {
                let ray = camera_ray::<f32>(&field.camera, field.filter, place);
                (ray.origin.0.map(f64::from), ray.direction.0.map(f64::from))
            };
            if count == self.rays.len() {
                let volumes = field.volumes.infos.len();
                self.rays.push(Ray {
                    pixel,
                    origin,
                    direction,
                    way: Way { from: 0.0, span: 0.0, steps: 0 },
                    light: Light::default(),
                    goes_on: false,
                    last: vec![End::Unseen; volumes],
                    ends: vec![[End::Unseen; PLACES]; volumes],
                    wanted: 0,
                });
            }
            let ray = &mut self.rays[count];
            (ray.pixel, ray.origin, ray.direction) = (pixel, origin, direction);
            ray.way = Way::of(&field.volumes.infos, field.volumes.step, origin, direction);
            ray.goes_on = ray.way.steps > 0;
            ray.light = Light::default();
            ray.last.fill(End::Unseen);
            count += 1;
        }
        let mut rays = std::mem::take(&mut self.rays);
        #[cfg(target_arch = "x86_64")]
        if self.is_wide {
            // SAFETY: the processor has these.
            unsafe { self.follow_wide(&mut rays[..count]) };
        } else {
            self.follow(&mut rays[..count]);
        }
        #[cfg(not(target_arch = "x86_64"))]
        self.follow(&mut rays[..count]);
        rays[..count].iter().for_each(|ray| done(ray.pixel, ray.light));
        self.rays = rays;
    }

    /// The same, compiled for what the processor has.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn follow_wide(&mut self, rays: &mut [Ray]) {
        self.follow(rays);
    }

    #[inline(always)]
    fn follow(&mut self, rays: &mut [Ray]) {
        let step = f64::from(self.field.volumes.step);
        let mut first = 0;
        while rays.iter().any(|ray| ray.goes_on) {
            for volume in 0..self.field.volumes.infos.len() {
                self.look_all(rays, volume, first);
                let places = self.field.volumes.infos[volume].block;
                for from in (0..PLACES as u32).step_by(places as usize) {
                    self.scalars(rays, volume, first + from, (from, places));
                }
            }
            for ray in rays.iter_mut().filter(|ray| ray.goes_on) {
                ray.compose(self.field, first, step);
            }
            first += PLACES as u32;
        }
    }

    /// Which places of a block are asked for, and what the others show.
    #[inline(always)]
    fn look_all(&self, rays: &mut [Ray], volume: usize, first: u32) {
        let info = &self.field.volumes.infos[volume];
        let (grid, step) = (&info.grid, self.field.volumes.step);
        let cells = &self.field.volumes.cells[info.first_cell as usize..];
        let high = grid.resolution.map(|n| n as f32);
        for ray in rays.iter_mut().filter(|ray| ray.goes_on) {
            let ends = &mut ray.ends[volume];
            ends.fill(End::Unreached);
            ray.wanted = 0;
            let t = (ray.way.from + f64::from(first) * f64::from(step)) as f32;
            let mut off = [[0.0f32; PLACES]; 3];
            for i in 0..3 {
                let begin = (ray.origin[i] as f32 - grid.origin[i]) * grid.inverse_edge;
                let slope = ray.direction[i] as f32 * grid.inverse_edge;
                for k in 0..PLACES {
                    off[i][k] = begin + (t + k as f32 * step) * slope;
                }
            }
            for k in 0..PLACES {
                let x = [off[0][k], off[1][k], off[2][k]];
                if ray.way.is_border(first + k as u32)
                    || (0..3).any(|i| !(x[i] >= 0.0 && x[i] < high[i]))
                {
                    continue;
                }
                let [x, y, z] = x.map(|x| x as u32);
                let cell = x + grid.resolution[0] * (y + grid.resolution[1] * z);
                // In f64, wherever a place is.
                let shows = cells[cell as usize].counts & CELL_KINDS != CELL_NOTHING;
                if shows || self.how == How::Direct {
                    ray.wanted |= 1 << k;
                } else {
                    ends[k] = End::Unseen;
                }
            }
        }
    }

    /// The scalars of a volume at some places of a block.
    #[inline(always)]
    fn scalars(&mut self, rays: &mut [Ray], volume: usize, first: u32, (from, places): (u32, u32)) {
        let own = |ray: &Ray| ray.wanted >> from & ((1u32 << places) - 1);
        let asks = |ray: &Ray| ray.goes_on && own(ray) != 0;
        let all = rays.iter().filter(|ray| asks(ray)).fold(0, |all, ray| all | own(ray));
        if all == 0 {
            return;
        }
        let (info, cells) = (&self.field.volumes.infos[volume], &self.field.cells[volume]);
        let step = f64::from(self.field.volumes.step);
        let x_at = |ray: &Ray, place: u32| {
            let t = ray.way.from + f64::from(place) * step;
            [0, 1, 2].map(|i| ray.origin[i] + t * ray.direction[i])
        };
        if self.is_wide {
            let block = around(rays.iter().filter(|ray| asks(ray)), (first, all), step, x_at);
            // SAFETY: the processor has these.
            #[cfg(target_arch = "x86_64")]
            let sought =
                unsafe { gather::avx2::points_near(info, cells, &block, &mut self.points) };
            #[cfg(not(target_arch = "x86_64"))]
            let sought = 0;
            self.counts.sought += sought;
        }
        for ray in rays.iter_mut().filter(|ray| asks(ray)) {
            let wanted = own(ray);
            self.counts.samples += u64::from(wanted.count_ones());
            if self.how == How::Direct {
                for k in (0..places).filter(|k| wanted >> k & 1 == 1) {
                    let end = direct::end_at(info, cells, x_at(ray, first + k));
                    ray.ends[volume][(from + k) as usize] = end;
                }
                continue;
            }
            let block = Block {
                first: x_at(ray, first).map(|x| x as f32),
                direction: ray.direction.map(|x| x as f32),
                step: step as f32,
                from: wanted.trailing_zeros() as f32 * step as f32,
                to: (31 - wanted.leading_zeros()) as f32 * step as f32,
                wider: 0.0,
            };
            let [numerators, denominators] = self.sums(info, cells, &block);
            for k in (0..places as usize).filter(|k| wanted >> k & 1 == 1) {
                if denominators[k] > 0.0 {
                    let scalar = f64::from(numerators[k] / denominators[k]);
                    ray.ends[volume][from as usize + k] = End::At(scalar);
                }
            }
        }
    }

    #[inline(always)]
    fn sums(&mut self, info: &VolumeInfo, cells: &Cells, block: &Block) -> [[f32; PLACES]; 2] {
        let (near, points, counts) = (&mut self.near, &self.points, &mut self.counts);
        #[cfg(target_arch = "x86_64")]
        if self.is_wide {
            // SAFETY: the processor has these.
            return unsafe {
                if self.how == How::Counted {
                    gather::avx2::sums::<true>(info, points, block, near, counts)
                } else {
                    gather::avx2::sums::<false>(info, points, block, near, counts)
                }
            };
        }
        let _ = (near, points);
        gather::plain(info, cells, block, counts)
    }
}

/// The way in the middle of those of some rays, and how far away from it they are: farthest at the ends, since ways are straight.
#[inline(always)]
fn around<'r>(
    rays: impl Iterator<Item = &'r Ray> + Clone,
    (first, all): (u32, u32),
    step: f64,
    x_at: impl Fn(&Ray, u32) -> [f64; 3],
) -> Block {
    let places = [all.trailing_zeros(), 31 - all.leading_zeros()];
    let count = rays.clone().count() as f64;
    let ends = places.map(|place| {
        let mut sum = [0.0; 3];
        for ray in rays.clone() {
            let x = x_at(ray, first + place);
            (0..3).for_each(|i| sum[i] += x[i] / count);
        }
        sum
    });
    let square = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>();
    let off = |ray: &Ray| {
        let off = [0, 1].map(|i| square(x_at(ray, first + places[i]), ends[i]));
        off[0].max(off[1])
    };
    let wider = rays.clone().map(off).fold(0.0, f64::max).sqrt();
    let length = square(ends[0], ends[1]).sqrt();
    let direction = match length > 0.0 {
        true => [0, 1, 2].map(|i| ((ends[1][i] - ends[0][i]) / length) as f32),
        false => [1.0, 0.0, 0.0],
    };
    Block {
        first: ends[0].map(|x| x as f32),
        direction,
        step: step as f32,
        from: 0.0,
        to: length as f32,
        wider: (wider * 1.000_01) as f32,
    }
}

impl Ray {
    /// Goes on by a block of places.
    #[inline(always)]
    fn compose(&mut self, field: &Field<'_>, first: u32, step: f64) {
        let count = (self.way.steps + 1 - first).min(PLACES as u32) as usize;
        let is_scalar = |end: &End| matches!(end, End::At(_));
        let seen = self.last.iter().any(is_scalar) || self.ends.iter().flatten().any(is_scalar);
        for k in 0..if seen { count } else { 0 } {
            let begin = f64::from((first + k as u32).max(1) - 1) * step;
            let length = step.min(self.way.span - begin);
            let there = |volume: usize| match k {
                0 => self.last[volume],
                k => self.ends[volume][k - 1],
            };
            let both = self.ends.iter().enumerate().map(|(volume, ends)| (there(volume), ends[k]));
            self.light.add(both, &field.transfers, length);
            if self.light.is_over() {
                self.goes_on = false;
                return;
            }
        }
        self.last.iter_mut().zip(&self.ends).for_each(|(last, ends)| *last = ends[count - 1]);
        self.goes_on = first + (PLACES as u32) <= self.way.steps;
    }
}

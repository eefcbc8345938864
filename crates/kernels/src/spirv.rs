//! The kernels and their variants, in one table, and the committed modules that they are compiled to.
//!
//! A row is a file of `glsl/kernels/`, what it does, and its axes. Each axis has values, and each of these has macros that the
//! source is compiled with; every combination is a module in `spirv/`, named after the kernel and its values.

use std::collections::BTreeMap;
use std::sync::OnceLock;

/// A value of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AxisValue {
    /// What the names of modules have for it; empty where it is the plain one.
    pub suffix: &'static str,
    /// Macros that it defines.
    pub macros: &'static [&'static str],
}

macro_rules! axes {
    ($($(#[$doc:meta])* $axis:ident {
        $($(#[$value_doc:meta])* $value:ident = $suffix:literal [$($macro:ident),*],)*
    })*) => {
        $($(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $axis { $($(#[$value_doc])* $value,)* }

        impl $axis {
            const VALUES: &'static [AxisValue] =
                &[$(AxisValue { suffix: $suffix, macros: &[$(stringify!($macro)),*] }),*];

            fn value(self) -> &'static AxisValue {
                &Self::VALUES[self as usize]
            }
        })*
    };
}

axes! {
    /// Where the ray state lives.
    Rays {
        /// In four images, twice (\[T\] §5). Lists are read from storage buffers.
        Images = "" [],
        /// In a buffer; what no dispatch writes meanwhile is read as texels.
        Queue = "queue" [QUEUE, TEXELS],
    }
    /// How a build reads points and polynomials.
    Lists {
        /// From storage buffers.
        Storage = "" [],
        /// As texels, where the device takes so many: lavapipe reads those of all lanes at once.
        Texels = "texels" [TEXELS],
    }
    /// The same, and how many neighbours a point has.
    Neighbors {
        /// Many, from storage buffers.
        Storage = "" [],
        /// Many, as texels.
        Texels = "texels" [TEXELS],
        /// At most 16, as texels.
        Few = "texels_few" [TEXELS, FEW],
    }
    /// The same of a search.
    Finding {
        /// Many, from storage buffers.
        Storage = "" [],
        /// Many, as texels.
        Texels = "texels" [TEXELS],
        /// At most 16, as texels.
        Few = "texels_few" [TEXELS, FEW],
        /// At most 16, as texels, where no two are equally far.
        Untied = "untied" [TEXELS, FEW, UNTIED],
    }
    /// Where rays start.
    Start {
        /// At the camera.
        Camera = "" [],
        /// On a surface, whose own sheet they do not meet again at once.
        Surface = "leaving" [LEAVING],
    }
    /// What the camera's rays go through.
    Camera {
        /// By the discs of their screen tile.
        Discs = "" [],
        /// Through the tree.
        Tree = "tree" [TREE],
    }
    /// What the nodes of a level of the tree are around.
    Children {
        /// The boxes of the level below.
        Boxes = "" [],
        /// The surfaces of points.
        Surfaces = "surfaces" [SURFACES],
    }
    /// Which rays go through volumes.
    Marching {
        /// Those of a wave.
        Wave = "" [],
        /// Those of a wave, where lamps light volumes.
        Lit = "lit" [LIT],
        /// Those of a wave, where volumes scatter them.
        Scattered = "scattered" [SCATTERED],
        /// Shadow rays.
        Shadows = "shadows" [SHADOWS],
    }
    /// How directions towards the background are drawn.
    Drawing {
        /// By how the surface scatters.
        Lobe = "" [],
        /// By how bright it is there.
        Table = "table" [TABLE],
    }
    /// Which rays look for isosurfaces.
    Searching {
        /// Those of a wave.
        Wave = "" [],
        /// Shadow rays, which any blocks.
        Shadows = "shadows" [SHADOWS],
        /// Shadow rays that go on through those of glass.
        Passing = "passing" [PASSING],
    }
}

/// A row of the table.
#[derive(Debug, Clone, Copy)]
pub struct Kernel {
    /// The stem of its source.
    pub name: &'static str,
    /// Its axes, in the order of their parts of a module's name.
    pub axes: &'static [&'static [AxisValue]],
}

macro_rules! kernels {
    ($($(#[$doc:meta])* $name:ident($($part:ident: $axis:ident),*);)*) => {
        /// Every kernel.
        pub const KERNELS: &[Kernel] =
            &[$(Kernel { name: stringify!($name), axes: &[$($axis::VALUES),*] }),*];

        $($(#[$doc])*
        #[must_use]
        pub fn $name($($part: $axis),*) -> &'static Module {
            module(stringify!($name), &[$($part.value()),*])
        })*
    };
}

kernels! {
    /// Adds a sample to each pixel's sum.
    accumulate();
    /// How far the nearest of each point can be.
    bound_reach(neighbors: Neighbors);
    /// The camera's ray of each pixel.
    camera_rays(rays: Rays);
    /// The first wave from the eye to the film, where rays of a queue need none.
    camera_trace(through: Camera);
    /// Where each cell's entries begin.
    cell_offsets();
    /// What becomes of each ray of a wave.
    classify(rays: Rays);
    /// Trust balls that end at rims.
    clip_balls();
    /// Bits set in each word of marks.
    count_marked();
    /// Screen tiles that each disc covers.
    disc_count(rays: Rays);
    /// Pairs of screen tile and point.
    disc_emit(rays: Rays);
    /// Where each screen tile's points begin and end.
    disc_ranges();
    /// The nearest hit among the points of a screen tile.
    disc_trace(rays: Rays);
    /// The nearest of each point.
    find_neighbors(finding: Finding);
    /// The local polynomial of each point.
    fit_polynomials(neighbors: Neighbors);
    /// Boxes of points that the balls of others touch.
    gather_leaves(lists: Lists);
    /// Cells that each trust ball meets.
    grid_count(lists: Lists);
    /// Pairs of cell and point.
    grid_emit(lists: Lists);
    /// Those of large balls.
    grid_emit_large(lists: Lists);
    /// Where each cell's points begin and end.
    grid_ranges();
    /// One pass of the traversal of the grid.
    grid_trace(start: Start, rays: Rays);
    /// Cells beside marked ones.
    grow_marks();
    /// Where rays first meet an isosurface.
    isosurface(of: Searching, rays: Rays);
    /// Boxes around points.
    leaf_boxes(lists: Lists);
    /// The rays that are marked, one after another.
    list_marked();
    /// The points of each cell with their positions.
    list_points(lists: Lists);
    /// Rays through volumes.
    march(of: Marching, rays: Rays);
    /// Cells that have points.
    mark_occupied();
    /// Boxes around boxes.
    node_boxes();
    /// Trust balls in the order that the grid lists them in.
    order_balls(lists: Lists);
    /// What of a light's reaches the points of a volume.
    point_lights(rays: Rays);
    /// Rays from the points of a volume towards a light.
    point_rays(rays: Rays);
    /// One iteration of each pending hit towards the point set surface.
    refine(rays: Rays);
    /// Sends rays whose hit was refined away on to the next.
    resume(rays: Rays);
    /// Prefix sums, second half.
    scan_apply();
    /// Prefix sums, first half.
    scan_reduce();
    /// The rays that surfaces send on.
    scatter(rays: Rays);
    /// What lit surfaces make of the light that reaches them.
    shade(rays: Rays);
    /// Shadow rays on the other side of surfaces that let them through.
    shadow_go_on(rays: Rays);
    /// What shadow rays start inside.
    shadow_media(rays: Rays);
    /// What the surfaces that shadow rays have met do to light.
    shadow_meet(rays: Rays);
    /// Rays towards a light.
    shadow_rays(rays: Rays);
    /// Discs as polynomials.
    shape_discs();
    /// Spheres as polynomials.
    shape_spheres();
    /// How far empty cells are from others.
    skip_cells();
    /// Rays towards the background.
    sky_rays(by: Drawing, rays: Rays);
    /// Feature sizes as means over neighbours.
    smooth_sizes(lists: Lists);
    /// Stable sort by one digit, first half.
    sort_count();
    /// Stable sort by one digit, second half.
    sort_scatter();
    /// Where each ray met the polynomial it hit.
    surface_hit(rays: Rays);
    /// Nodes of one level of the tree.
    tree_nodes(children: Children);
    /// One pass of the traversal of the tree.
    tree_trace(start: Start);
}

/// Whether a kernel lets rays go through the points.
#[must_use]
pub fn is_traversal(kernel: &str) -> bool {
    kernel.ends_with("_trace")
}

/// A committed module. There is no way to make another, so who has one may trust it: its words are valid SPIR-V
/// with one compute entry point, or none, where it was not committed.
#[derive(Debug)]
pub struct Module {
    name: String,
    kernel: &'static str,
    macros: Vec<&'static str>,
    bytes: &'static [u8],
    words: OnceLock<Vec<u32>>,
}

impl Module {
    /// The stem of its file.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The kernel that it is a variant of.
    #[must_use]
    pub fn kernel(&self) -> &'static str {
        self.kernel
    }

    /// The macros that its source is compiled with.
    #[must_use]
    pub fn macros(&self) -> &[&'static str] {
        &self.macros
    }

    /// Its words, made from its bytes when they are first asked for.
    pub fn words(&self) -> &[u32] {
        self.words.get_or_init(|| {
            let word = |word: &[u8]| u32::from_le_bytes([word[0], word[1], word[2], word[3]]);
            self.bytes.chunks_exact(4).map(word).collect()
        })
    }
}

/// Names and bytes of the files in `spirv/`, by name.
const FILES: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/modules.rs"));

/// Every module, by its name; one that is not committed yet has no words.
pub fn modules() -> &'static BTreeMap<String, Module> {
    static MODULES: OnceLock<BTreeMap<String, Module>> = OnceLock::new();
    MODULES.get_or_init(|| KERNELS.iter().flat_map(variants).collect())
}

/// All combinations of a kernel's axes.
fn variants(kernel: &Kernel) -> Vec<(String, Module)> {
    let mut chosen: Vec<Vec<&'static AxisValue>> = vec![Vec::new()];
    for axis in kernel.axes {
        let with = |values: &Vec<&'static AxisValue>| {
            axis.iter().map(|value| [&values[..], &[value]].concat()).collect::<Vec<_>>()
        };
        chosen = chosen.iter().flat_map(with).collect();
    }
    let module = |values: &Vec<&'static AxisValue>| {
        let name = name_of(kernel.name, values);
        let file = FILES.binary_search_by(|file| file.0.cmp(&name));
        let bytes = file.map_or(&[][..], |at| FILES[at].1);
        let macros = values.iter().flat_map(|value| value.macros).copied().collect();
        (name.clone(), Module { name, kernel: kernel.name, macros, bytes, words: OnceLock::new() })
    };
    chosen.iter().map(module).collect()
}

fn name_of(kernel: &str, values: &[&'static AxisValue]) -> String {
    let suffixes = values.iter().map(|value| value.suffix).filter(|suffix| !suffix.is_empty());
    std::iter::once(kernel).chain(suffixes).collect::<Vec<_>>().join("_")
}

fn module(kernel: &'static str, values: &[&'static AxisValue]) -> &'static Module {
    let name = name_of(kernel, values);
    // The table has all combinations of a kernel's axes, and these are one.
    modules().get(&name).unwrap_or_else(|| unreachable!("{name}: a combination of axes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_module_is_committed_and_no_other() {
        let files: Vec<&str> = FILES.iter().map(|file| file.0).collect();
        let modules: Vec<&str> = modules().keys().map(String::as_str).collect();
        assert_eq!(files, modules, "files of spirv/ and modules of the table");
    }
}

//! One finished picture, and what is said about it in a file's header.

/// One finished picture: the pixels of the data window, row-major, row 0 at the top.
///
/// Every plane holds `window.width * window.height` pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// Width and height of the full image in pixels: the display window.
    pub size: [u32; 2],
    /// The part of the image that was rendered: the data window.
    pub window: Window,
    /// Whether the background was left out. The colours are premultiplied by alpha then.
    pub transparent: bool,
    /// Radiance R, G, B in linear Rec. 709, and coverage A.
    pub color: Vec<[f32; 4]>,
    /// Where glass treats the channels differently: coverage of R, G and B, each 1 less what comes through of the
    /// background by glass and volumes alone. A transparent film then leaves that background out.
    pub channel_alpha: Option<Vec<[f32; 3]>>,
    /// Distance to the first surface along the camera's viewing axis, +inf where there is none.
    pub depth: Vec<f32>,
    /// World position of the first surface, 0 where there is none.
    pub position: Vec<[f32; 3]>,
    /// Unit world normal of the first surface, facing the viewer, 0 where there is none.
    pub normal: Vec<[f32; 3]>,
    /// Index of the first surface's object, −1 where there is none.
    pub object: Vec<f32>,
    /// Further planes by the names that their channels have in an EXR. Names are distinct, not
    /// empty, and none of `R G B A AR AG AB Z P.X P.Y P.Z N.X N.Y N.Z object`. Other formats leave them out.
    pub extra: Vec<(String, Vec<f32>)>,
}

/// A rectangle of pixels inside an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Column of its left edge.
    pub x: u32,
    /// Row of its upper edge.
    pub y: u32,
    /// Columns, at least one.
    pub width: u32,
    /// Rows, at least one.
    pub height: u32,
}

/// Where a picture comes from: its camera and its settings, as an EXR's header tells them.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// World to camera for row vectors, v·M: the translation is the last row. Relative to `origin`.
    /// The camera looks along −z, +y up.
    pub world_to_camera: [[f32; 4]; 4],
    /// World to normalized device coordinates for row vectors, before the division by w: x right,
    /// y down, (0, 0) and (1, 1) the corners of the full image. Relative to `origin`.
    pub world_to_ndc: [[f32; 4]; 4],
    /// The centre that was subtracted from world coordinates. Written as `pointillist/origin`.
    pub origin: [f64; 3],
    /// Key and value of each setting, written as the string attributes `pointillist/<key>`. Keys
    /// are distinct, not empty, not `origin`.
    pub settings: Vec<(String, String)>,
}

impl Window {
    /// The window that is the whole of an image of this width and height.
    pub fn whole(size: [u32; 2]) -> Self {
        let [width, height] = size;
        Self { x: 0, y: 0, width, height }
    }

    /// How many pixels it has.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}

impl Film {
    /// A film on which nothing was hit: black, with nothing covered.
    pub fn empty(size: [u32; 2], window: Window, transparent: bool) -> Self {
        let pixels = window.pixels();
        Self {
            size,
            window,
            transparent,
            color: vec![[0.0; 4]; pixels],
            channel_alpha: None,
            depth: vec![f32::INFINITY; pixels],
            position: vec![[0.0; 3]; pixels],
            normal: vec![[0.0; 3]; pixels],
            object: vec![-1.0; pixels],
            extra: Vec::new(),
        }
    }

    /// Holds what the fields' descriptions promise about lengths and windows.
    pub(crate) fn assert_consistent(&self) {
        let Window { x, y, width, height } = self.window;
        let inside = |start: u32, extent: u32, size: u32| {
            extent > 0 && start.checked_add(extent).is_some_and(|end| end <= size)
        };
        assert!(
            inside(x, width, self.size[0]) && inside(y, height, self.size[1]),
            "film: window {:?} is empty or leaves the image of {:?}",
            self.window,
            self.size
        );
        let pixels = self.window.pixels();
        let planes = [
            ("color", self.color.len()),
            ("depth", self.depth.len()),
            ("position", self.position.len()),
            ("normal", self.normal.len()),
            ("object", self.object.len()),
        ];
        if let Some(alpha) = &self.channel_alpha {
            assert_eq!(alpha.len(), pixels, "film: pixels of the channels' alpha");
        }
        let extra = self.extra.iter().map(|(name, plane)| (name.as_str(), plane.len()));
        for (plane, length) in planes.into_iter().chain(extra) {
            assert_eq!(length, pixels, "film: pixels of plane '{plane}' against the window's");
        }
    }
}

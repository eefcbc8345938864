//! What can be wrong with a scene once its points are known.

use crate::Window;
use points::CloudError;

/// What is wrong with a scene once its points are known.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The points cannot be rendered together.
    #[error(transparent)]
    Points(#[from] CloudError),
    /// The watcher asked for an end.
    #[error("interrupted")]
    Interrupted,
    /// A camera whose keys do not go with the points.
    #[error("{0}")]
    Camera(String),
    /// A sky whose sun is below its horizon.
    #[error(
        "background.sky.sun: found a direction {degrees:.2} degrees below the horizon where up is {up:?}, expected one at \
         or above it; raise it, or give camera.up"
    )]
    SunBelowHorizon {
        /// How far it is below.
        degrees: f64,
        /// The camera's up.
        up: [f64; 3],
    },
    /// A material asks for colours that the file lacks.
    #[error(
        "object '{name}': material.albedo is \"points\" but {file} has no colours; give a colour \
         such as [0.8, 0.8, 0.8] or leave albedo out"
    )]
    NoColors {
        /// The object.
        name: String,
        /// Its point file.
        file: String,
    },
    /// A volume asks for an attribute that the file lacks.
    #[error(
        "object '{name}': its volume asks for the attribute '{attribute}' but {file} has none of that name; \
         it has {known}"
    )]
    NoVolumeAttribute {
        /// The object.
        name: String,
        /// What was asked for.
        attribute: String,
        /// Its point file.
        file: String,
        /// Names that would do.
        known: String,
    },
    /// A step so short that rays would never end.
    #[error(
        "a step of {step:e} scene units is too short: a ray through the scene's volumes would take up to \
         {samples:.1e} samples, and 1.6e7 is the limit; lengthen objects.volume.step"
    )]
    TooManySamples {
        /// The shortest step of a volume.
        step: f32,
        /// Along the longest ray.
        samples: f64,
    },
    /// A volume that has to be the only one, among others.
    #[error(
        "object '{name}': its volume's mode is not \"emission\", for which it has to be the scene's only volume, \
         but there are {count}; render them one by one, or leave mode out"
    )]
    SeveralVolumes {
        /// The object.
        name: String,
        /// Volumes of the scene.
        count: usize,
    },
    /// More lights than a lit volume takes.
    #[error(
        "object '{name}': its volume has a shading, for which a scene may have 4 lights, but there are \
         {lights}, where a sky's sun counts; leave some out, or set shading = \"none\""
    )]
    TooManyVolumeLights {
        /// The object.
        name: String,
        /// Lights of the scene, with a sky's sun.
        lights: usize,
    },
    /// An isosurface of glass of a kernel whose isosurfaces have rims.
    #[error(
        "object '{name}': its isosurface is of glass but its kernel is \"shepard\", whose isosurfaces end where \
         the points do, so that rays cannot tell inside from outside; set volume.kernel to \"sum\" or \"sph\""
    )]
    OpenIsosurface {
        /// The object.
        name: String,
    },
    /// An isosurface with an albedo of points.
    #[error(
        "object '{name}': an isosurface has one albedo, but material asks for a texture or for the points' own; \
         give a colour such as [0.8, 0.8, 0.8] or leave albedo out"
    )]
    IsosurfaceAlbedo {
        /// The object.
        name: String,
    },
    /// A material asks for an attribute that the file lacks.
    #[error(
        "object '{name}': material.albedo is \"attribute:{attribute}\" but {file} has no such attribute; it \
         has {known}"
    )]
    NoAttribute {
        /// The object.
        name: String,
        /// What was asked for.
        attribute: String,
        /// Its point file.
        file: String,
        /// Names that would do.
        known: String,
    },
    /// Spheres or discs ask for an attribute that the file lacks.
    #[error(
        "object '{name}': surface.radius is \"attribute:{attribute}\" but {file} has no such attribute; it has \
         {known}"
    )]
    NoRadii {
        /// The object.
        name: String,
        /// What was asked for.
        attribute: String,
        /// Its point file.
        file: String,
        /// Names that would do.
        known: String,
    },
    /// An attribute without one finite value.
    #[error(
        "object '{name}': material.albedo is \"attribute:{attribute}\" but none of its values in {file} is \
         finite; take another attribute"
    )]
    NoValues {
        /// The object.
        name: String,
        /// What was asked for.
        attribute: String,
        /// Its point file.
        file: String,
    },
    /// A volume of which no point can be shown.
    #[error(
        "object '{name}': its volume shows the attribute '{attribute}' but no point in {file} has a finite value \
         of it, or of what else its kernel takes; take another attribute"
    )]
    NoScalars {
        /// The object.
        name: String,
        /// What was asked for.
        attribute: String,
        /// Its point file.
        file: String,
    },
    /// A logarithmic scale without a value that it shows.
    #[error(
        "object '{name}': scale = \"log\" shows positive values, but '{attribute}' has none in {file}; leave scale out, or \
         give a value_range"
    )]
    NothingPositive {
        /// The object.
        name: String,
        /// What was asked for.
        attribute: String,
        /// Its point file.
        file: String,
    },
    /// A texture by u and v for points that have none.
    #[error(
        "object '{name}': material.texture_axis is \"uv\" but {file} has no attributes u and v (nor s and t, \
         texture_u and texture_v); project the texture along \"x\", \"y\" or \"z\""
    )]
    NoPlaces {
        /// The object.
        name: String,
        /// Its point file.
        file: String,
    },
    /// More texels than 32 bits can count.
    #[error("the images of the scene, with {0}, are over 4294967295 numbers; make them smaller")]
    TooManyTexels(String),
    /// Degrees of no place on Earth.
    #[error(
        "object '{name}': point {index} of {file} has longitude {x} and latitude {y}, but degrees go to 360 and \
         90 ({count} such points); {advice}",
        x = .place[0], y = .place[1]
    )]
    NoPlace {
        /// The object.
        name: String,
        /// Its point file.
        file: String,
        /// Place in the file of the first such point, from 0.
        index: u32,
        /// Its x and y.
        place: [f64; 2],
        /// How many there are.
        count: usize,
        /// What to do.
        advice: String,
    },
    /// A crop that is not inside the picture.
    #[error(
        "--crop {x},{y},{width},{height} does not lie inside the picture of {image_width}x{image_height} \
         pixels; give X,Y,W,H with W and H at least 1",
        x = .crop.origin[0], y = .crop.origin[1], width = .crop.size[0], height = .crop.size[1],
        image_width = .image[0], image_height = .image[1]
    )]
    Crop {
        /// What was asked for.
        crop: Window,
        /// Columns and rows of the picture.
        image: [u32; 2],
    },
    /// More colours than 32 bits of offset can count.
    #[error(
        "the scene has {0} coloured points but at most 1000000000 are supported; thin the point sets"
    )]
    TooManyColors(usize),
}

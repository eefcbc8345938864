//! Two-dimensional storage images, in layout `GENERAL` from creation to end.

use crate::access;
use crate::device::Device;
use crate::error::GpuError;
use crate::next_id;
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocation;
use std::fmt;
use std::sync::Arc;

/// What a pixel is made of: four values of 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ImageFormat {
    /// `rgba32ui`
    Rgba32Uint,
    /// `rgba32f`
    Rgba32Float,
}

impl ImageFormat {
    /// Bytes of a pixel.
    pub const PIXEL_BYTES: u64 = 16;

    fn vk(self) -> vk::Format {
        match self {
            Self::Rgba32Uint => vk::Format::R32G32B32A32_UINT,
            Self::Rgba32Float => vk::Format::R32G32B32A32_SFLOAT,
        }
    }
}

/// A storage image. Cloning gives another handle to the same image; the last one frees it.
#[derive(Clone)]
pub struct Image {
    pub(crate) inner: Arc<ImageInner>,
}

pub(crate) struct ImageInner {
    pub(crate) raw: vk::Image,
    pub(crate) view: vk::ImageView,
    pub(crate) size: [u32; 2],
    pub(crate) format: ImageFormat,
    pub(crate) id: u64,
    pub(crate) name: &'static str,
    allocation: Option<Allocation>,
    device: Arc<Device>,
}

impl Image {
    /// An image whose content is undefined.
    ///
    /// # Panics
    /// Where a side is zero.
    pub fn new(
        device: &Arc<Device>,
        name: &'static str,
        size: [u32; 2],
        format: ImageFormat,
    ) -> Result<Self, GpuError> {
        let [width, height] = size;
        assert!(width > 0 && height > 0, "image '{name}' is {width} x {height} pixels");
        let limit = device.limits().max_image_dimension_2d;
        if width.max(height) > limit {
            return Err(GpuError::ImageTooLarge { name, width, height, limit });
        }
        let raw = &device.raw;
        let usage = vk::ImageUsageFlags::STORAGE
            | vk::ImageUsageFlags::TRANSFER_SRC
            | vk::ImageUsageFlags::TRANSFER_DST;
        // SAFETY: the device belongs to this instance.
        let allowed = unsafe {
            device.instance().raw().get_physical_device_image_format_properties(
                device.physical,
                format.vk(),
                vk::ImageType::TYPE_2D,
                vk::ImageTiling::OPTIMAL,
                usage,
                vk::ImageCreateFlags::empty(),
            )
        }
        .map_err(GpuError::call("vkGetPhysicalDeviceImageFormatProperties", name))?;
        let bytes = packed_bytes(size);
        if bytes > allowed.max_resource_size {
            return Err(GpuError::OutOfMemory { object: name, bytes });
        }
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format.vk())
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(usage)
            .initial_layout(vk::ImageLayout::UNDEFINED);
        // SAFETY: all devices allow storage images of these formats, and the sides are in range.
        let image = unsafe { raw.create_image(&info, None) }
            .map_err(GpuError::call("vkCreateImage", name))?;
        // From here on `Drop` cleans up after a failure.
        let mut inner = ImageInner {
            raw: image,
            view: vk::ImageView::null(),
            size,
            format,
            id: next_id(),
            name,
            allocation: None,
            device: Arc::clone(device),
        };
        device.set_name(image, name);
        // SAFETY: `image` was made by this device.
        let requirements = unsafe { raw.get_image_memory_requirements(image) };
        let allocation = device.allocate(name, requirements, MemoryLocation::GpuOnly, false)?;
        let allocation = inner.allocation.insert(allocation);
        // SAFETY: the memory was allocated for this image's requirements, nothing was bound to
        // it before, and it is freed after the image is destroyed.
        unsafe { raw.bind_image_memory(image, allocation.memory(), allocation.offset()) }
            .map_err(GpuError::call("vkBindImageMemory", name))?;
        let view = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(format.vk())
            .subresource_range(access::WHOLE_IMAGE);
        // SAFETY: the image has memory, and the view is of all of it in its own format.
        inner.view = unsafe { raw.create_image_view(&view, None) }
            .map_err(GpuError::call("vkCreateImageView", name))?;
        device.set_name(inner.view, name);
        // SAFETY: the image is new, of this device, and `inner` keeps it until the job is done.
        unsafe {
            device.queue().once(device, name, |commands| {
                access::first_layout(raw, commands, image);
            })?;
        }
        Ok(Self { inner: Arc::new(inner) })
    }

    /// A number of its own, shared by its clones.
    pub fn id(&self) -> u64 {
        self.inner.id
    }

    /// Its name in messages.
    pub fn name(&self) -> &'static str {
        self.inner.name
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.inner.size
    }

    /// What its pixels are made of.
    pub fn format(&self) -> ImageFormat {
        self.inner.format
    }

    /// Device memory it takes, padding included.
    pub fn bytes(&self) -> u64 {
        self.inner.allocation.as_ref().map_or(0, Allocation::size)
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { inner } = self;
        f.debug_struct("Image")
            .field("name", &inner.name)
            .field("size", &inner.size)
            .field("format", &inner.format)
            .finish_non_exhaustive()
    }
}

impl ImageInner {
    /// The device it belongs to.
    pub(crate) fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Bytes of its pixels, row after row without gaps.
    pub(crate) fn packed_bytes(&self) -> u64 {
        packed_bytes(self.size)
    }
}

fn packed_bytes([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height) * ImageFormat::PIXEL_BYTES
}

impl Drop for ImageInner {
    fn drop(&mut self) {
        let raw = &self.device.raw;
        // SAFETY: created by this device; a `Recorder` holds an `Arc` of every image it used
        // until its fence has signalled, so no pending work refers to it. Descriptor sets that
        // still name it are found by its id, and so never used again. A view left null by a
        // failed `new` is ignored.
        unsafe {
            raw.destroy_image_view(self.view, None);
            raw.destroy_image(self.raw, None);
        }
        self.device.free(self.allocation.take());
    }
}

//! Barriers: what must wait for what.
//!
//! [`Hazards`] remembers how each resource was used since the last barrier. A command that
//! conflicts with that gets one memory barrier over everything before it, which also clears the
//! memory. Two commands that only read the same resource, or touch different ones, get none.
//! `a_missing_barrier_is_collected` holds that synchronization validation would see a lack.

use ash::vk;
use std::collections::HashMap;

/// How a command uses a resource.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Access {
    /// Its content is read and stays as it was.
    Read,
    /// Its content is written, and perhaps read too.
    Write,
}

/// Uses of each resource, by id, since the last barrier.
#[derive(Debug, Default)]
pub(crate) struct Hazards {
    uses: HashMap<u64, Access>,
}

impl Hazards {
    /// Notes the uses of the next command, and says whether a barrier must come before it.
    pub(crate) fn command(&mut self, uses: &[(u64, Access)]) -> bool {
        let conflicts = uses.iter().any(|(id, access)| match (self.uses.get(id), access) {
            (None, _) | (Some(Access::Read), Access::Read) => false,
            (Some(Access::Write), _) | (Some(Access::Read), Access::Write) => true,
        });
        if conflicts {
            self.uses.clear();
        }
        for &(id, access) in uses {
            let use_of_id = self.uses.entry(id).or_insert(access);
            if access == Access::Write {
                *use_of_id = Access::Write;
            }
        }
        conflicts
    }

    /// Forgets everything, for a new recording.
    pub(crate) fn clear(&mut self) {
        self.uses.clear();
    }
}

/// Every stage in which this crate's commands run.
const STAGES: vk::PipelineStageFlags = vk::PipelineStageFlags::from_raw(
    vk::PipelineStageFlags::COMPUTE_SHADER.as_raw()
        | vk::PipelineStageFlags::TRANSFER.as_raw()
        | vk::PipelineStageFlags::DRAW_INDIRECT.as_raw(),
);

/// Every way in which they write.
const WRITES: vk::AccessFlags = vk::AccessFlags::from_raw(
    vk::AccessFlags::SHADER_WRITE.as_raw() | vk::AccessFlags::TRANSFER_WRITE.as_raw(),
);

/// Every way in which they touch memory.
const ALL: vk::AccessFlags = vk::AccessFlags::from_raw(
    WRITES.as_raw()
        | vk::AccessFlags::SHADER_READ.as_raw()
        | vk::AccessFlags::TRANSFER_READ.as_raw()
        | vk::AccessFlags::INDIRECT_COMMAND_READ.as_raw(),
);

/// Records a barrier between what came before and what follows in this queue.
///
/// # Safety
/// `commands` is in the recording state, on `raw`, for a queue with compute.
pub(crate) unsafe fn barrier(raw: &ash::Device, commands: vk::CommandBuffer) {
    let memory = vk::MemoryBarrier::default().src_access_mask(WRITES).dst_access_mask(ALL);
    // SAFETY: as the caller promises; a compute queue has all the stages named.
    unsafe {
        raw.cmd_pipeline_barrier(
            commands,
            STAGES,
            STAGES,
            vk::DependencyFlags::empty(),
            &[memory],
            &[],
            &[],
        );
    }
}

/// Records the barrier that ends a command buffer: what was written becomes visible to the host,
/// once the fence has signalled, and to every later submission.
///
/// # Safety
/// As for [`barrier`].
pub(crate) unsafe fn release(raw: &ash::Device, commands: vk::CommandBuffer) {
    let memory = vk::MemoryBarrier::default()
        .src_access_mask(WRITES)
        .dst_access_mask(ALL | vk::AccessFlags::HOST_READ);
    // SAFETY: as the caller promises; a compute queue has all the stages named.
    unsafe {
        raw.cmd_pipeline_barrier(
            commands,
            STAGES,
            STAGES | vk::PipelineStageFlags::HOST,
            vk::DependencyFlags::empty(),
            &[memory],
            &[],
            &[],
        );
    }
}

/// Records the one layout transition of an image: from nothing to `GENERAL`.
///
/// # Safety
/// As for [`barrier`]; `image` was made by `raw` and has been used by no command.
pub(crate) unsafe fn first_layout(
    raw: &ash::Device,
    commands: vk::CommandBuffer,
    image: vk::Image,
) {
    let transition = vk::ImageMemoryBarrier::default()
        .dst_access_mask(ALL & !vk::AccessFlags::INDIRECT_COMMAND_READ)
        .old_layout(vk::ImageLayout::UNDEFINED)
        .new_layout(vk::ImageLayout::GENERAL)
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .image(image)
        .subresource_range(WHOLE_IMAGE);
    // SAFETY: as the caller promises; nothing came before, so there is nothing to wait for.
    unsafe {
        raw.cmd_pipeline_barrier(
            commands,
            vk::PipelineStageFlags::TOP_OF_PIPE,
            STAGES,
            vk::DependencyFlags::empty(),
            &[],
            &[],
            &[transition],
        );
    }
}

/// The one level and layer of an [`Image`](crate::Image).
pub(crate) const WHOLE_IMAGE: vk::ImageSubresourceRange = vk::ImageSubresourceRange {
    aspect_mask: vk::ImageAspectFlags::COLOR,
    base_mip_level: 0,
    level_count: 1,
    base_array_layer: 0,
    layer_count: 1,
};

#[cfg(test)]
mod tests {
    use super::*;
    use Access::{Read, Write};

    #[test]
    fn only_conflicts_get_a_barrier() {
        let mut hazards = Hazards::default();
        assert!(!hazards.command(&[(1, Read), (2, Write)]));
        assert!(!hazards.command(&[(1, Read), (3, Write)]), "reads share, others differ");
        assert!(hazards.command(&[(3, Read)]), "read after write");
        assert!(!hazards.command(&[(2, Read)]), "the barrier covered resource 2 as well");
        assert!(hazards.command(&[(2, Write)]), "write after read");
        assert!(hazards.command(&[(2, Write)]), "write after write");
        hazards.clear();
        assert!(!hazards.command(&[(2, Write)]));
    }

    #[test]
    fn one_command_that_reads_and_writes_a_resource_counts_as_a_write() {
        for uses in [[(1, Read), (1, Write)], [(1, Write), (1, Read)]] {
            let mut hazards = Hazards::default();
            assert!(!hazards.command(&uses), "within one dispatch no barrier can help");
            assert!(hazards.command(&[(1, Read)]));
        }
    }
}

//! How passes use resources, and the barriers that follow.

use ash::vk;

/// One way of using a buffer or an image. The crate computes and copies, nothing else, so this list is complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Access {
    /// Not used yet; contents undefined.
    None,
    /// Perhaps used, in any way, by commands that were perhaps submitted; contents undefined.
    Unknown,
    /// Source of a copy.
    TransferRead,
    /// Destination of a copy, a clear or a fill.
    TransferWrite,
    /// Sampled or fetched in a compute shader; the image is in `SHADER_READ_ONLY_OPTIMAL`.
    SampledRead,
    /// Sampled, fetched, or loaded as a storage image, in a compute shader while the image stays in `GENERAL`; loaded from a texel buffer.
    SampledGeneral,
    /// Read and written as a storage buffer, texel buffer or image (`GENERAL`).
    Storage,
    /// Group counts of an indirect dispatch, and read by the shader that is dispatched.
    Indirect,
    /// Read by the host after the frame has completed.
    HostRead,
}

/// What an access means to Vulkan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Masks {
    pub(crate) stage: vk::PipelineStageFlags,
    pub(crate) access: vk::AccessFlags,
    pub(crate) layout: vk::ImageLayout,
    pub(crate) writes: bool,
}

impl Access {
    /// Every access.
    #[cfg(test)]
    pub(crate) const ALL: [Self; 9] = [
        Self::None,
        Self::Unknown,
        Self::TransferRead,
        Self::TransferWrite,
        Self::SampledRead,
        Self::SampledGeneral,
        Self::Storage,
        Self::Indirect,
        Self::HostRead,
    ];

    /// Stage, access and layout.
    pub(crate) const fn masks(self) -> Masks {
        use vk::{AccessFlags as A, ImageLayout as L, PipelineStageFlags as S};
        let (stage, access, layout, writes) = match self {
            Self::None => (S::TOP_OF_PIPE, A::empty(), L::UNDEFINED, false),
            Self::Unknown => (S::ALL_COMMANDS, A::MEMORY_WRITE, L::UNDEFINED, true),
            Self::TransferRead => (
                S::TRANSFER,
                A::TRANSFER_READ,
                L::TRANSFER_SRC_OPTIMAL,
                false,
            ),
            Self::TransferWrite => (
                S::TRANSFER,
                A::TRANSFER_WRITE,
                L::TRANSFER_DST_OPTIMAL,
                true,
            ),
            Self::SampledRead => (
                S::COMPUTE_SHADER,
                A::SHADER_READ,
                L::SHADER_READ_ONLY_OPTIMAL,
                false,
            ),
            Self::SampledGeneral => (S::COMPUTE_SHADER, A::SHADER_READ, L::GENERAL, false),
            Self::Storage => (
                S::COMPUTE_SHADER,
                A::from_raw(A::SHADER_READ.as_raw() | A::SHADER_WRITE.as_raw()),
                L::GENERAL,
                true,
            ),
            Self::Indirect => (
                S::from_raw(S::DRAW_INDIRECT.as_raw() | S::COMPUTE_SHADER.as_raw()),
                A::from_raw(A::INDIRECT_COMMAND_READ.as_raw() | A::SHADER_READ.as_raw()),
                L::GENERAL,
                false,
            ),
            Self::HostRead => (S::HOST, A::HOST_READ, L::GENERAL, false),
        };
        Masks {
            stage,
            access,
            layout,
            writes,
        }
    }

    /// True when `next` has to wait for `self`, or the image has to change its layout in between.
    pub(crate) fn needs_barrier(self, next: Self, is_image: bool) -> bool {
        let (a, b) = (self.masks(), next.masks());
        let first_use = matches!(self, Self::None);
        let relayout = is_image && a.layout != b.layout;
        let hazard = !first_use && (a.writes || b.writes);
        relayout || hazard
    }
}

#[cfg(test)]
mod tests {
    use super::Access;

    /// Every ordered pair: a barrier for read-after-write, write-after-read and write-after-write, none between reads.
    #[test]
    fn barriers_between_every_pair_of_buffer_accesses() {
        let writes = [Access::Unknown, Access::TransferWrite, Access::Storage];
        for a in Access::ALL {
            for b in Access::ALL {
                let expected = a != Access::None && (writes.contains(&a) || writes.contains(&b));
                assert_eq!(a.needs_barrier(b, false), expected, "{a:?} then {b:?}");
            }
        }
    }

    #[test]
    fn images_also_change_layout() {
        assert!(Access::None.needs_barrier(Access::SampledRead, true));
        assert!(Access::TransferRead.needs_barrier(Access::SampledRead, true));
        assert!(!Access::SampledGeneral.needs_barrier(Access::SampledGeneral, true));
        assert!(Access::SampledRead.needs_barrier(Access::SampledGeneral, true));
        assert!(!Access::SampledRead.needs_barrier(Access::SampledRead, true));
    }

    /// The light volume is accumulated by dispatches that the validation layer does not tell apart; the table must.
    #[test]
    fn accumulation_waits_for_itself() {
        assert!(Access::Storage.needs_barrier(Access::Storage, true));
    }
}

//! Names and labels for debuggers and validation messages.

use std::ffi::CString;

use ash::{ext, vk};

/// `VK_EXT_debug_utils`, where the host enabled it.
pub(crate) struct Debug {
    names: Option<ext::debug_utils::Device>,
}

impl Debug {
    pub(crate) fn new(instance: &ash::Instance, device: &ash::Device, enabled: bool) -> Self {
        Self {
            names: enabled.then(|| ext::debug_utils::Device::new(instance, device)),
        }
    }

    pub(crate) fn name<H: vk::Handle>(&self, handle: H, name: &str) {
        let (Some(names), Ok(name)) = (&self.names, CString::new(name)) else {
            return;
        };
        let info = vk::DebugUtilsObjectNameInfoEXT::default()
            .object_handle(handle)
            .object_name(&name);
        // SAFETY: the handle was just created by this context's device and is not shared yet. A name that cannot be set
        // is only a missing name.
        let _ = unsafe { names.set_debug_utils_object_name(&info) };
    }

    /// # Safety
    /// `cmd` is recording.
    pub(crate) unsafe fn begin(&self, cmd: vk::CommandBuffer, label: &str) {
        if let (Some(names), Ok(label)) = (&self.names, CString::new(label)) {
            let info = vk::DebugUtilsLabelEXT::default().label_name(&label);
            // SAFETY: this function's contract.
            unsafe { names.cmd_begin_debug_utils_label(cmd, &info) };
        }
    }

    /// # Safety
    /// `cmd` is recording, inside a label begun by [`Debug::begin`].
    pub(crate) unsafe fn end(&self, cmd: vk::CommandBuffer) {
        if let Some(names) = &self.names {
            // SAFETY: this function's contract.
            unsafe { names.cmd_end_debug_utils_label(cmd) };
        }
    }
}

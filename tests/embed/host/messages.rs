//! What the validation layers say.

use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, PoisonError};

use ash::vk;

/// Warnings and errors, in order.
#[derive(Default)]
pub(crate) struct Messages(Mutex<Vec<String>>);

impl Messages {
    pub(crate) fn all(&self) -> Vec<String> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// A messenger that appends to `self`, which has to outlive it.
    pub(crate) fn messenger_info(
        self: &Arc<Self>,
    ) -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
        vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(
                vk::DebugUtilsMessageSeverityFlagsEXT::WARNING
                    | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR,
            )
            .message_type(
                vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION
                    | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE,
            )
            .pfn_user_callback(Some(append))
            .user_data(Arc::as_ptr(self).cast_mut().cast())
    }
}

/// # Safety
/// Called by Vulkan with the pointer given at creation, to [`Messages`] that outlive the messenger.
unsafe extern "system" fn append(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: by this function's contract; the layers give every message a text.
    let (messages, text) = unsafe {
        let text = CStr::from_ptr((*data).p_message)
            .to_string_lossy()
            .into_owned();
        (&*user.cast::<Messages>(), text)
    };
    messages
        .0
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .push(text);
    vk::FALSE
}

//! `umbravox devices`.

use umbravox::Result;
use umbravox::headless::{self, DeviceInfo};

use crate::args::DevicesArgs;
use crate::terminal;

pub(crate) fn run(args: &DevicesArgs) -> Result<()> {
    let devices = headless::devices()?;
    if args.json {
        return terminal::print_json(&devices);
    }
    if devices.is_empty() {
        return terminal::print("no Vulkan device\n");
    }
    terminal::print(&devices.iter().map(describe).collect::<String>())
}

fn describe(device: &DeviceInfo) -> String {
    let verdict = match (device.usable, &device.reason) {
        (true, _) => "usable".to_owned(),
        (false, Some(reason)) => format!("not usable: {reason}"),
        (false, None) => "not usable".to_owned(),
    };
    format!(
        "{}  {} ({}, Vulkan {}, {})\n   {verdict}\n",
        device.index, device.name, device.device_type, device.api_version, device.driver
    )
}

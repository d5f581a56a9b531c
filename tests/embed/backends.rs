//! Every source of memory: the same picture, and nothing left behind.

use std::collections::BTreeMap;
use std::ptr::NonNull;
use std::sync::{Arc, Mutex};

use ash::vk;
use umbravox::Error;
use umbravox::embed::{
    Background, FrameCamera, MappedPointer, MemoryBackend, MemoryBlock, MemoryLocation,
    MemoryRequest, Renderer,
};
use umbravox::gpu::HostMemory;

use crate::host::{Host, Look, Stage};
use crate::scenes::{SIZE, Subject, ball};

const RGBA32F: vk::Format = vk::Format::R32G32B32A32_SFLOAT;

/// A memory object for every request, refused by name where the test says so.
pub(crate) struct Dedicated {
    device: ash::Device,
    /// By location.
    types: [(MemoryLocation, vk::MemoryPropertyFlags); 3],
    properties: vk::PhysicalDeviceMemoryProperties,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    live: usize,
    requests: BTreeMap<String, u64>,
    refused: Option<String>,
}

impl Dedicated {
    pub(crate) fn new(host: &Host) -> Arc<Self> {
        let coherent =
            vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        // SAFETY: the physical device is the instance's.
        let properties = unsafe {
            host.instance
                .get_physical_device_memory_properties(host.physical_device)
        };
        Arc::new(Self {
            device: host.device.clone(),
            types: [
                (
                    MemoryLocation::Device,
                    vk::MemoryPropertyFlags::DEVICE_LOCAL,
                ),
                (MemoryLocation::Upload, coherent),
                (MemoryLocation::Readback, coherent),
            ],
            properties,
            state: Mutex::default(),
        })
    }

    /// From now on requests whose name contains `part` fail; `None`: all succeed.
    pub(crate) fn refuse(&self, part: Option<&str>) {
        self.state.lock().unwrap().refused = part.map(str::to_owned);
    }

    /// Objects that have memory now.
    pub(crate) fn live(&self) -> usize {
        self.state.lock().unwrap().live
    }

    /// Bytes of the last request of a name.
    fn requested(&self, name: &str) -> Option<u64> {
        self.state.lock().unwrap().requests.get(name).copied()
    }
}

// SAFETY: each block is a memory object of its own, of the size and type asked for, mapped as a whole until it is freed.
unsafe impl MemoryBackend for Dedicated {
    fn allocate(&self, request: &MemoryRequest<'_>) -> Result<MemoryBlock, String> {
        let mut state = self.state.lock().unwrap();
        let size = request.requirements.size;
        state.requests.insert(request.name.into(), size);
        if let Some(part) = &state.refused
            && request.name.contains(part)
        {
            return Err(format!("no memory for {part}"));
        }
        let wanted = self
            .types
            .iter()
            .find(|(location, _)| *location == request.location)
            .map(|(_, flags)| *flags)
            .ok_or("no such location")?;
        let memory_type = self
            .properties
            .memory_types_as_slice()
            .iter()
            .enumerate()
            .position(|(i, t)| {
                request.requirements.memory_type_bits >> i & 1 == 1
                    && t.property_flags.contains(wanted)
            })
            .ok_or("no such memory")?;
        let info = vk::MemoryAllocateInfo::default()
            .allocation_size(size)
            .memory_type_index(memory_type as u32);
        // SAFETY: the device is alive; the type is one that the object allows.
        let memory =
            unsafe { self.device.allocate_memory(&info, None) }.map_err(|e| e.to_string())?;
        let mapped = if request.location == MemoryLocation::Device {
            None
        } else {
            let flags = vk::MemoryMapFlags::empty();
            // SAFETY: fresh host-visible memory. Freeing it unmaps it.
            let pointer = unsafe { self.device.map_memory(memory, 0, vk::WHOLE_SIZE, flags) };
            let pointer = pointer.map_err(|e| e.to_string())?;
            NonNull::new(pointer.cast()).map(MappedPointer)
        };
        state.live += 1;
        Ok(MemoryBlock {
            memory,
            offset: 0,
            size,
            mapped,
            token: Box::new(()),
        })
    }

    unsafe fn free(&self, block: MemoryBlock) {
        self.state.lock().unwrap().live -= 1;
        // SAFETY: by contract the block is ours, freed once, and not in use.
        unsafe { self.device.free_memory(block.memory, None) };
    }

    fn name(&self) -> &'static str {
        "dedicated"
    }
}

/// The picture with memory from a back end; all of it is given back.
fn picture(host: &Host, subject: &Subject, memory: HostMemory, name: &str) -> Vec<[f64; 4]> {
    let context = host.context(memory);
    assert_eq!(context.memory_backend(), name);
    assert_eq!(context.allocated_bytes(), 0);
    let mut renderer = subject.renderer(&context);
    assert!(context.allocated_bytes() > 0);
    let mut stage = Stage::new(host, RGBA32F, SIZE);
    let look = Look {
        camera: FrameCamera::View(subject.view(SIZE)),
        background: Background::Transparent,
        encode_srgb: false,
    };
    let picture = stage.draw(&look, &mut [&mut renderer]);
    let newest = stage.destroy();
    drop(renderer);
    assert!(
        context.allocated_bytes() > 0,
        "nothing is destroyed before the host says that it may be"
    );
    // SAFETY: the stage has waited for all its frames.
    unsafe { context.collect(newest) };
    assert_eq!(context.allocated_bytes(), 0, "{name}");
    picture
}

#[test]
fn every_back_end_gives_the_same_picture_and_gets_all_back() {
    let subject = ball();
    let host = Host::new();
    let expected = picture(&host, &subject, HostMemory::GpuAllocator, "gpu-allocator");

    let allocator = shared_gpu_allocator(&host);
    let memory = HostMemory::SharedGpuAllocator(Arc::clone(&allocator));
    let shared = picture(&host, &subject, memory, "gpu-allocator");
    assert!(shared == expected, "shared gpu-allocator");
    let report = allocator.lock().unwrap().generate_report();
    assert_eq!(report.allocations.len(), 0, "the host's allocator");
    drop(allocator);

    let dedicated = Dedicated::new(&host);
    let memory = HostMemory::Custom(dedicated.clone());
    assert!(
        picture(&host, &subject, memory, "dedicated") == expected,
        "dedicated"
    );
    assert_eq!(dedicated.live(), 0);

    #[cfg(feature = "vk-mem")]
    {
        assert!(
            picture(&host, &subject, HostMemory::Vma, "vma") == expected,
            "vma"
        );
        let info =
            vk_mem::AllocatorCreateInfo::new(&host.instance, &host.device, host.physical_device);
        // SAFETY: the handles are alive and belong together; the allocator goes before them.
        let allocator = Arc::new(unsafe { vk_mem::Allocator::new(info) }.unwrap());
        let memory = HostMemory::SharedVma(Arc::clone(&allocator));
        assert!(
            picture(&host, &subject, memory, "vma") == expected,
            "shared vma"
        );
        assert_eq!(Arc::strong_count(&allocator), 1);
    }
    host.finish();
}

fn shared_gpu_allocator(host: &Host) -> Arc<Mutex<gpu_allocator::vulkan::Allocator>> {
    let info = gpu_allocator::vulkan::AllocatorCreateDesc {
        instance: host.instance.clone(),
        device: host.device.clone(),
        physical_device: host.physical_device,
        debug_settings: Default::default(),
        buffer_device_address: false,
        allocation_sizes: Default::default(),
    };
    Arc::new(Mutex::new(
        gpu_allocator::vulkan::Allocator::new(&info).unwrap(),
    ))
}

#[test]
fn out_of_memory_names_what_asked_for_how_much() {
    let subject = ball();
    let host = Host::new();
    let dedicated = Dedicated::new(&host);
    let context = host.context(HostMemory::Custom(dedicated.clone()));
    for name in [
        "umbravox.atlas",
        "umbravox.light",
        "umbravox.index",
        "umbravox.skip",
        "umbravox.transfer",
        "umbravox.bricks",
    ] {
        dedicated.refuse(Some(name));
        let error = Renderer::new(&context, Arc::clone(&subject.volume), subject.settings())
            .err()
            .expect("the back end refuses");
        let asked = dedicated.requested(name).expect("it was asked");
        assert!(asked > 0);
        match &error {
            Error::OutOfMemory {
                what,
                bytes,
                detail,
                ..
            } => {
                assert_eq!((what.as_str(), *bytes), (name, asked));
                assert_eq!(detail, &format!("no memory for {name}"));
            }
            other => panic!("{name}: {other}"),
        }
        let shown = error.to_string();
        assert!(
            shown.contains(&format!("{name} asked for {asked} bytes")),
            "{shown}"
        );
    }
    // SAFETY: nothing was ever submitted.
    unsafe { context.collect(0) };
    assert_eq!((context.allocated_bytes(), dedicated.live()), (0, 0));
    drop(context);
    host.finish();
}

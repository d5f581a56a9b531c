#![no_main]
umbravox_fuzz::reader!(OPENVDB);

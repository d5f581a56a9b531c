#![no_main]
umbravox_fuzz::reader!(CODED_PIXELS);

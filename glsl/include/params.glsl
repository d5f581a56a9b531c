// The volume's parameters, for passes that need nothing else of it.

layout(set = 0, binding = BINDING_VOLUME) uniform VolumeBlock { VolumeParams volume_block; };
// Copied, so that what loops need is loaded before them: CPU drivers load again wherever the block is named.
VolumeParams volume = volume_block;

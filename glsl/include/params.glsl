// The volume's parameters, for passes that need nothing else of it.

layout(set = 0, binding = BINDING_VOLUME) uniform VolumeBlock { VolumeParams volume; };

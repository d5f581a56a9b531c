// Texels of gradients with ten bits a component: no gradient is this.
const int TEN_BITS_ZERO = 512;

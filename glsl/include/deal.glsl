// Which piece of work a workgroup takes.

// Drivers that run on a processor may cut a dispatch into as many runs of consecutive workgroups, one for each thread, before it
// starts; 1 where workgroups are handed out as threads become free.
layout(constant_id = SPEC_RUNS) const uint RUNS = 1;

// How often a whole number goes into another, both below 2^20. (Division of integers is slow.)
uint times_in(uint number, uint whole) {
    return uint((float(whole) + 0.5) / float(number));
}

// Workgroups of a dispatch of two dimensions that a run takes one after the other before the next ones are another run's.
const uint DEALT_AT_ONCE = 8u;

// Which of consecutive workgroups one takes, and the run that it is in: of as many each, and every run has some from everywhere.
struct Dealt {
    uvec2 group;
    uint run;
};

Dealt dealt_group() {
    uint width = gl_NumWorkGroups.x;
    uint at = gl_WorkGroupID.y * width + gl_WorkGroupID.x;
    uint hand = width * gl_NumWorkGroups.y / (RUNS * DEALT_AT_ONCE) * DEALT_AT_ONCE;
    uint run = times_in(max(hand, 1u), at);
    uint within = at - run * hand;
    bool deals = at < hand * RUNS;
    uint piece = deals ? (within / DEALT_AT_ONCE * RUNS + run) * DEALT_AT_ONCE + within % DEALT_AT_ONCE : at;
    uint row = times_in(width, piece);
    return Dealt(uvec2(piece - row * width, row), deals ? run : (at - hand * RUNS) % RUNS);
}

// The piece for workgroup `at` of `count`: every run gets pieces from everywhere, so that all take about as long. Neighbours go to
// different threads at about the same time.
uint dealt(uint at, uint count) {
    if (RUNS == 1u) {
        return at;
    }
    uint hand = count / RUNS;
    uint run = times_in(max(hand, 1u), at);
    return at < hand * RUNS ? (at - run * hand) * RUNS + run : at;
}

// Which piece of work a workgroup takes.

// Drivers that run on a processor may cut a dispatch into as many runs of consecutive workgroups, one for each thread, before it
// starts; 1 where workgroups are handed out as threads become free.
layout(constant_id = SPEC_RUNS) const uint RUNS = 1;

// The piece for workgroup `at` of `count`: every run gets pieces from everywhere, so that all take about as long. Neighbours go to
// different threads at about the same time.
uint dealt(uint at, uint count) {
    if (RUNS == 1u) {
        return at;
    }
    uint hand = count / RUNS;
    uint run = uint((float(at) + 0.5) / float(max(hand, 1u)));
    return at < hand * RUNS ? (at - run * hand) * RUNS + run : at;
}

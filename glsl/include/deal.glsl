// Which piece of work a workgroup takes.

// Drivers that run on a processor may cut a dispatch into as many runs of consecutive workgroups, one for each thread, before it
// starts; 1 where workgroups are handed out as threads become free.
layout(constant_id = SPEC_RUNS) const uint RUNS = 1;

// How often a whole number goes into another, both below 2^20. (Division of integers is slow.)
uint times_in(uint number, uint whole) {
    return uint((float(whole) + 0.5) / float(number));
}

// What is taken of pieces of work, and the run that takes it.
struct Dealt {
    uint piece;
    uint run;
};

// For workgroup `at` of `count`, where a run takes so many pieces `at_once` before the next ones are another run's: every run gets as many,
// and some from everywhere, so that all take about as long. What is left over goes round.
Dealt deal(uint at, uint count, uint at_once) {
    uint hand = count / (RUNS * at_once) * at_once;
    uint run = times_in(max(hand, 1u), at);
    uint within = at - run * hand;
    bool deals = at < hand * RUNS;
    uint piece = (within / at_once * RUNS + run) * at_once + within % at_once;
    return Dealt(deals ? piece : at, deals ? run : (at - hand * RUNS) % RUNS);
}

// The piece for workgroup `at` of `count`: neighbours go to different threads at about the same time.
uint dealt(uint at, uint count) {
    if (RUNS == 1u) {
        return at;
    }
    return deal(at, count, 1u).piece;
}

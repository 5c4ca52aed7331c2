// Whether a bounce from the receiver counts the lamps that it hits: all of them, until other paths find some, too.
bool counts_lamps(Receiver receiver) { return true; }

"""Takes a history step by step, with loads of its own. Usage: step_history.py DECK"""
import sys

import amontons

stepper = amontons.Stepper(sys.argv[1])
state = stepper.rest()
for time, push in enumerate([0.0, 10.0, 15.0, 5.0]):
    state = stepper.step(state, time, factor_F=push, factor_f=1.0)  # state in, state out
    print(push, state.columns["ux_1"], state.columns["dissipation"], state.status)

"""Every integrator over the step lengths, on the rotor, the bars and the ratchet.

`grid` runs what `experiments` lists and keeps the rows in one table; `findings` reads it, `figures`
and `page` show it.
"""

# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # One impact, looked at
#
# The Panda's hand meets a chest. Cells begin with `# %%`: open this file in VS Code, Spyder or
# JupyterLab (with jupytext) as a notebook, or run it as it is.

# %%
from softimpact import (
    Approach,
    Contact,
    analyse,
    assess_impact,
    body_region,
    drives,
    impact_model,
    load_robot,
)

panda = load_robot("panda")
model = impact_model(panda, drives=drives(panda, joint_stiffness=1e4))
q, along_y = [-1.22, 0.84, 0.72, -2.41, 0.79, 1.97, -2.04], [0.0, 1.0, 0.0]

# %% [markdown]
# What the body meets: masses, stiffness, impact factors.

# %%
analyse(model, q, along_y)

# %% [markdown]
# What happens, at both ends of what the motors may do, and how fast it may be.

# %%
chest = Contact(body_region("chest"))
found = assess_impact(model, Approach(q, along_y, speed=0.5), chest, safe_speed=True)
found

# %%
axes = found.plot()
axes.set_title(f"{found.history.peak:.0f} N at 0.5 m/s; safe up to {found.safe_speed:.2f} m/s")

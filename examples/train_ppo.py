"""PPO of your own, in PyTorch, in 128 copies of a learned simulator. `lodestone deploy` drives what it learns.

    PYTHONPATH=build/release/python /usr/bin/python3 examples/train_ppo.py models/dynamics_best runs/ppo [UPDATES]

It needs Gymnasium and PyTorch. What it prints is of the episodes as they were explored.
"""
import sys

import lodestone
import numpy as np
import torch
from torch import nn
from torch.distributions import Normal

ENVIRONMENTS, STEPS, EPOCHS, MINIBATCHES = 128, 40, 4, 8
DISCOUNT, LAMBDA, CLIP, LEARNING_RATE = 0.97, 0.95, 0.2, 1e-3

torch.manual_seed(1)
torch.set_num_threads(1)  # sums then come out the same everywhere
environments = lodestone.make_vec(sys.argv[1], ENVIRONMENTS, "centre", seed=1, copy=True)
size = environments.single_observation_space.shape[0]
actor = nn.Sequential(nn.Linear(size, 64), nn.ReLU(), nn.Linear(64, 64), nn.ReLU(), nn.Linear(64, 2), nn.Tanh())
critic = nn.Sequential(nn.Linear(size, 64), nn.ReLU(), nn.Linear(64, 64), nn.ReLU(), nn.Linear(64, 1), nn.Flatten(0))
log_sigma = nn.Parameter(torch.full((2,), -0.7))
optimiser = torch.optim.Adam([*actor.parameters(), *critic.parameters(), log_sigma], LEARNING_RATE)

observation, _ = environments.reset()
for update in range(int(sys.argv[3]) if len(sys.argv) > 3 else 40):
    steps, reached = [], []
    for _ in range(STEPS):
        with torch.no_grad():
            chance = Normal(actor(torch.from_numpy(observation)), log_sigma.exp())
            action = chance.sample()
        seen, (observation, reward, terminated, truncated, infos) = observation, environments.step(action.numpy())
        over = terminated | truncated  # there, `observation` is the next episode's first one already
        after = np.where(over[:, None], infos.get("final_obs", observation), observation)
        steps.append((seen, action, chance.log_prob(action).sum(1), reward, after, ~terminated, ~over))
        reached += [*infos["success"][over]]
    columns = [torch.as_tensor(np.stack(column)) for column in zip(*steps)]  # each [STEPS, ENVIRONMENTS, ...]
    seen, action, log_chance, reward, after, alive, same_episode = columns
    with torch.no_grad():  # an episode that was cut was worth what the critic expects of its last observation
        value, value_after = (critic(rows.flatten(0, 1)).view(STEPS, -1) for rows in (seen, after))
        advantage = reward + DISCOUNT * alive * value_after - value
        for t in reversed(range(STEPS - 1)):  # generalised advantage estimation
            advantage[t] += DISCOUNT * LAMBDA * same_episode[t] * advantage[t + 1]
    columns = [column.flatten(0, 1) for column in (seen, action, log_chance, advantage, value + advantage)]
    for _ in range(EPOCHS):
        for rows in torch.randperm(STEPS * ENVIRONMENTS).chunk(MINIBATCHES):
            seen, action, log_chance, advantage, target = (column[rows] for column in columns)
            ratio = (Normal(actor(seen), log_sigma.exp()).log_prob(action).sum(1) - log_chance).exp()
            advantage = (advantage - advantage.mean()) / advantage.std()
            gain = torch.min(ratio * advantage, ratio.clamp(1 - CLIP, 1 + CLIP) * advantage).mean()
            optimiser.zero_grad()
            ((critic(seen) - target).square().mean() / 2 - gain).backward()
            optimiser.step()
    print(f"update {update + 1}: {100 * np.mean(reached):.1f} % reached the centre, reward {reward.mean():.3f} a pulse")
layers = [(layer.weight.detach().numpy(), layer.bias.detach().numpy()) for layer in actor[::2]]
lodestone.save_policy(sys.argv[2], layers, contract=environments.contract)

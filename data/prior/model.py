# SPDX-License-Identifier: Apache-2.0
"""The prior: a perceptron per pixel, and what its outputs mean"""
import numpy as np
import torch

OUTPUTS = 5  # shift of the logit, moments 1 (right, forward, up), spread


class Prior(torch.nn.Module):
    def __init__(self, inputs, hidden):
        super().__init__()
        self.register_buffer("mean", torch.zeros(inputs))
        self.register_buffer("inverse_deviation", torch.ones(inputs))
        sizes = (inputs, *hidden, OUTPUTS)
        self.layers = torch.nn.ModuleList(
            torch.nn.Linear(a, b) for a, b in zip(sizes[:-1], sizes[1:])
        )
        with torch.no_grad():
            self.layers[-1].weight.mul_(0.1)
            self.layers[-1].bias.zero_()

    def forward(self, x):
        h = ((x - self.mean) * self.inverse_deviation).clamp(-4, 4)
        for layer in self.layers[:-1]:
            h = torch.relu(layer(h))
        return self.layers[-1](h)


def mean_of(nets):
    """One network whose outputs are the means of those of networks with the same inputs"""
    parts = [net.layers for net in nets]
    both = Prior(nets[0].layers[0].in_features, tuple(
        sum(layer.out_features for layer in same) for same in zip(*parts)
    )[:-1])
    both.mean[:], both.inverse_deviation[:] = nets[0].mean, nets[0].inverse_deviation
    blocks = lambda same: torch.block_diag(*[layer.weight for layer in same])
    joined = lambda same: torch.cat([layer.bias for layer in same])
    first, *inner, last = zip(*parts)
    with torch.no_grad():
        both.layers[0].weight[:] = torch.cat([layer.weight for layer in first])
        both.layers[0].bias[:] = joined(first)
        for layer, same in zip(both.layers[1:-1], inner):
            layer.weight[:], layer.bias[:] = blocks(same), joined(same)
        both.layers[-1].weight[:] = torch.cat([layer.weight for layer in last], 1) / len(nets)
        both.layers[-1].bias[:] = sum(layer.bias for layer in last) / len(nets)
    return both.eval()


def answer(out, ao, guessed):
    """Outputs and the tool's ao and guessed -> ao, width of the interval it lies in, spread

    Known directions stay as they are: ao keeps to [ao - guessed, ao + guessed], cut to [0, 1]. The
    model shifts the logit of the place in it. Spread is the expected |error| of ao."""
    low = (ao - guessed).clamp(min=0)
    width = (ao + guessed).clamp(max=1) - low
    place = ((ao - low) / width.clamp(min=1e-4)).clamp(0.02, 0.98)
    shifted = torch.sigmoid(torch.log(place / (1 - place)) + 4 * out[..., 0])
    spread = 0.005 + width * torch.sigmoid(out[..., 4] - 1)
    return low + width * shifted, width, spread


def moments(out, width, tool):
    """Moments 1 of the visibility, (..., 3) in the axes of the features"""
    return tool + width[..., None] * out[..., 1:4]


def flat_weights(net):
    """Mean, 1 / deviation, then of each layer weights [out][in] and biases -> 1-D float32"""
    parts = [net.mean, net.inverse_deviation]
    for layer in net.layers:
        parts += [layer.weight, layer.bias]
    return np.concatenate([p.detach().numpy().astype("<f4").ravel() for p in parts])


def sizes(net):
    return [net.layers[0].in_features] + [layer.out_features for layer in net.layers]
